// The whole server as an object: store, jobs, workers, and gRPC in front of them.
//
//   auto server = BallpistonServer::Start(options);
//   ...
//   (*server)->Shutdown(std::chrono::seconds(10));
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/gpu/device_orbits.h"
#include "grpcpp/server.h"
#include "server/cluster/cluster.h"
#include "server/compute/model_ladder.h"
#include "server/compute/scheduler.h"
#include "server/compute/thread_executor.h"
#include "server/door/door.h"
#include "server/door/listen_address.h"
#include "server/periodic_thread.h"
#include "server/rpc/services.h"
#include "server/status/call_observer.h"
#include "server/status/metrics_endpoint.h"
#include "server/store/data_directory.h"
#include "server/store/store.h"

namespace ballpiston::server {

// Values of --device.
inline constexpr char kProcessor[] = "cpu";
inline constexpr char kGpu[] = "gpu";

struct ServerOptions {
  std::string data_dir = DataDirectory::Default();
  std::string listen;  // empty: a Unix socket in data_dir
  DoorOptions door;
  int workers = 1;
  std::string device = kProcessor;  // or kGpu; computes the flights of pairs for the workers
  std::optional<ClusterOptions> cluster = {};  // empty: only this server's threads compute
  std::optional<SlurmOptions> slurm = {};      // of the cluster; empty: somebody starts its workers
  std::shared_ptr<PointOpener> opener;         // null: the ladder of models opens points
  WatchTiming watch;
  Limits limits;
  std::string metrics_listen;  // HOST:PORT on the loopback; empty: no metrics
  Store::Options store;
};

class BallpistonServer {
 public:
  // Resumes unfinished jobs. The server answers calls when this returns.
  //   INVALID_ARGUMENT     an option is invalid; the message names its flag
  //   FAILED_PRECONDITION  data folder in use, or the store cannot be read
  //   UNAVAILABLE          an address cannot be used, or the disk fails
  //   PERMISSION_DENIED    data folder not writable
  static absl::StatusOr<std::unique_ptr<BallpistonServer>> Start(ServerOptions options);
  ~BallpistonServer();  // Shutdown, without time to drain

  // With the port that the server uses, also if the options have port 0.
  std::string address() const { return address_.Text(); }

  const Door& door() const { return *door_; }

  // Reads the access file and the certificates again; calls and connections go on. If a file is
  // invalid, the server keeps its previous contents, and the error names the file. One thread at a
  // time.
  absl::Status Reload() { return door_->Reload(); }
  // The address of the metrics; empty if there are none.
  std::string metrics_address() const { return metrics_ ? metrics_->address() : ""; }

  // How long no client has used the server and no thread has computed.
  std::chrono::steady_clock::duration IdleFor();

  // Sets health to NOT_SERVING, rejects new jobs, ends watches with UNAVAILABLE, drops blocks that
  // are not merged, gives calls in progress the time `drain` to end, and flushes the store.
  void Shutdown(std::chrono::milliseconds drain);
  // For a process that ends without the destructor. May be called while Shutdown runs.
  void LeaveDataFolder() const { directory_.Leave(); }

 private:
  BallpistonServer(ServerOptions options, DataDirectory directory, ListenAddress address,
                   std::unique_ptr<Door> door, std::unique_ptr<OrbitsOnDevice> device,
                   std::unique_ptr<Store> store);

  void StartThreads();
  absl::Status Listen();
  absl::Status StartMetrics();
  // While the disk rejects writes, the service that needs it is NOT_SERVING, so that clients can
  // choose another server. The other services and the whole server stay SERVING, because a restart
  // would not repair the disk. The same thread calls Streams::EndRevoked and, at a stop, ends all
  // connections when no call of the API is in progress.
  void StartHealth();

  const ServerOptions options_;
  DataDirectory directory_;  // first: its lock guards all later members
  ListenAddress address_;
  std::unique_ptr<Door> door_;
  std::atomic<bool> draining_ = false;
  bool shut_down_ = false;
  std::atomic<bool> stopping_ = false;  // gRPC is being shut down
  CallObserver calls_;
  std::unique_ptr<Store> store_;
  std::shared_ptr<CrashRecord> crashes_;
  ModelLadder ladder_;
  Scheduler scheduler_;
  JobBook book_;
  std::unique_ptr<OrbitsOnDevice> device_;  // null: the processor
  // After the book: the executors' threads use the book.
  ThreadExecutor threads_;
  std::unique_ptr<Cluster> cluster_;  // null without a cluster
  Quotas quotas_;
  Streams streams_;
  ServiceContext context_;
  EnsembleService ensemble_;
  AnalyticService analytic_;
  TraceService trace_;
  ServerService server_;
  std::unique_ptr<grpc::Server> grpc_;
  std::unique_ptr<PeriodicThread> limits_;    // calls JobBook::KeepLimits
  std::unique_ptr<PeriodicThread> looking_;   // sets health; ends streams and connections
  std::unique_ptr<MetricsEndpoint> metrics_;  // last: it reads all members above
};

}  // namespace ballpiston::server
