// The whole server as an object: store, jobs, workers, and gRPC in front of them.
//
//   auto server = BallpistonServer::Start(options);
//   ...
//   (*server)->Shutdown(std::chrono::seconds(10));
#ifndef BALLPISTON_SERVER_BALLPISTON_SERVER_H_
#define BALLPISTON_SERVER_BALLPISTON_SERVER_H_

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "grpcpp/server.h"
#include "grpcpp/server_builder.h"
#include "server/api/services.h"
#include "server/execution/slurm_executor.h"
#include "server/execution/thread_executor.h"
#include "server/listen_address.h"
#include "server/observability/call_observer.h"
#include "server/observability/health.h"
#include "server/observability/metrics_endpoint.h"
#include "server/periodic_thread.h"
#include "server/scheduling/model_ladder.h"
#include "server/scheduling/scheduler.h"
#include "server/security/peer_user.h"
#include "server/security/server_security.h"
#include "server/security/socket_listener.h"
#include "server/security/unix_users.h"
#include "server/store/data_directory.h"
#include "server/store/store.h"

namespace ballpiston::server {

// When a connection is given up, with the streams on it: one at whose other end nobody is any more,
// or one that is old.
struct ConnectionTiming {
  std::chrono::milliseconds handshake{20'000};      // the longest
  std::chrono::milliseconds ping_interval{60'000};  // of silence before the other end is asked
  std::chrono::milliseconds ping_timeout{20'000};   // and has to have answered

  // What a client's certificate once opened stays open as long as the connection. So where they are
  // asked for, a connection takes no more calls after so long (the client makes another, and does
  // not notice), and is closed when its calls have ended, or have had that long to.
  std::chrono::milliseconds certified_age{3'600'000};
  std::chrono::milliseconds certified_age_grace{300'000};
};

struct ServerOptions {
  std::string data_dir = DataDirectory::Default();
  std::string listen;  // empty: a Unix socket in data_dir
  SecurityOptions security;
  // The users who can connect to a Unix socket that is not open to others.
  std::set<uid_t> socket_users = OwnUserAndRoot();
  int workers = 1;
  std::optional<SlurmOptions> slurm = {};  // a cluster beside the threads
  ExperimentFactory factory;               // empty: the core's, by the chosen model
  WatchTiming watch;
  ConnectionTiming connections;
  Limits limits;
  std::string metrics_listen;  // HOST:PORT on the loopback; empty: no metrics
  Store::Options store;
};

class BallpistonServer {
 public:
  // Takes up unfinished jobs, and answers calls when it returns.
  //   INVALID_ARGUMENT     an option, named as the flag it comes from
  //   FAILED_PRECONDITION  data folder or address in use, or a store that cannot be read
  //   PERMISSION_DENIED    data folder not writable
  static absl::StatusOr<std::unique_ptr<BallpistonServer>> Start(ServerOptions options);
  ~BallpistonServer();  // Shutdown, without time to drain

  // The port that was chosen, if any was free to be.
  std::string address() const { return address_.Text(); }

  const ServerSecurity& security() const { return *security_; }

  // Reads the access file and the certificates again; calls and connections go on. Of what is wrong
  // the old stays, and is named in the error. One thread at a time.
  absl::Status Reload() { return security_->Reload(); }
  // Of the metrics; empty if there are none.
  std::string metrics_address() const { return metrics_ ? metrics_->address() : ""; }

  // How long nobody has used it and nothing was computed.
  std::chrono::steady_clock::duration IdleFor();

  // Health says NOT_SERVING, no job is accepted, watches end with UNAVAILABLE, blocks in flight are
  // dropped, calls in progress have until then to end, and everything is on disk.
  void Shutdown(std::chrono::milliseconds drain);

 private:
  BallpistonServer(ServerOptions options, DataDirectory directory, ListenAddress address,
                   std::unique_ptr<ServerSecurity> security, std::unique_ptr<Store> store);

  void StartExecutors();
  void StartKeepingLimits();
  absl::Status Listen();
  void BoundConnections(grpc::ServerBuilder& builder) const;
  // Returns the function that receives the connections of the server that is being built.
  SocketListener::Receive AddReceiver(grpc::ServerBuilder& builder);
  absl::Status StartMetrics();
  void StartHealth();

  const ServerOptions options_;
  DataDirectory directory_;  // first: its lock guards all that follows
  ListenAddress address_;
  std::unique_ptr<ServerSecurity> security_;
  std::atomic<bool> draining_ = false;
  bool shut_down_ = false;
  Activity activity_;
  CallObserver calls_;
  WatchRegistry watches_;
  std::unique_ptr<Store> store_;
  ModelLadder ladder_;
  std::unique_ptr<PointOpener> factory_;  // null: the ladder opens points
  Scheduler scheduler_;
  JobBook book_;
  // After the book, which the executors' threads use.
  ThreadExecutor threads_;
  std::unique_ptr<SlurmExecutor> slurm_;  // null without a cluster
  RpcExecutor executor_;
  ServiceContext context_;
  EnsembleService ensemble_;
  AnalyticService analytic_;
  TraceService trace_;
  ServerService server_;
  std::unique_ptr<UnixUsers> unix_users_;  // null unless a Unix socket is open to others
  std::unique_ptr<grpc::Server> grpc_;
  std::unique_ptr<SocketListener> listener_;
  std::unique_ptr<PeriodicThread> limits_;    // calls JobBook::KeepLimits
  std::unique_ptr<Health> health_;            // after grpc_, which has what it sets
  std::unique_ptr<MetricsEndpoint> metrics_;  // last: it asks all of the above
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_BALLPISTON_SERVER_H_
