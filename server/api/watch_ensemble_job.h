// WatchEnsembleJob: one write outstanding, and the next message made when it is done.
//
// What to say is decided when it can be said: whatever changed since the last message goes into one
// snapshot, so a slow reader costs neither memory nor anybody's time. Messages are made on the
// threads that answer calls, never on gRPC's, and outside of the lock the workers need.
//
// The resume token names the server's life, the job and the last change told. A token of another
// life or job is as good as none: the watch begins with everything.
#ifndef BALLPISTON_SERVER_API_WATCH_ENSEMBLE_JOB_H_
#define BALLPISTON_SERVER_API_WATCH_ENSEMBLE_JOB_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "grpcpp/support/server_callback.h"
#include "server/api/call.h"
#include "server/api/service_context.h"

namespace ballpiston::server {

class WatchReactor : public grpc::ServerWriteReactor<v1::WatchEnsembleJobResponse>,
                     public Watch,
                     public std::enable_shared_from_this<WatchReactor> {
 public:
  // Owns itself until gRPC is done with it. A call that was not admitted ends at once.
  static WatchReactor* Start(ServiceContext& service, absl::StatusOr<Call> call,
                             const v1::WatchEnsembleJobRequest& request);

  void Look(std::chrono::steady_clock::time_point now) override;

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  using Clock = std::chrono::steady_clock;

  WatchReactor(ServiceContext& service, absl::StatusOr<Call> call,
               const v1::WatchEnsembleJobRequest& request);

  // Has Advance run, once more if it is running now. At most one Advance runs at a time, and all
  // writes and the end come from it.
  void Schedule();
  void Advance();
  void TellWhatIsNew();

  absl::Status FindJob();  // sets job_, or leaves it empty if the job has ended
  bool TellJob();
  bool TellSnapshot();
  bool TellHeartbeat();

  void ReadToken(const std::string& token);
  std::string Token() const;
  void Write();
  void WriteLastAndEnd();
  void End(const absl::Status& status);

  ServiceContext& service_;
  const v1::WatchEnsembleJobRequest request_;
  const absl::StatusOr<Call> call_;
  const std::shared_ptr<void> active_;  // for Activity
  std::shared_ptr<WatchReactor> self_;

  // Of Advance.
  std::string id_;
  v1::WatchEnsembleJobResponse message_;
  std::string told_progress_;

  std::mutex mutex_;  // never held while gRPC is called
  bool scheduled_ = false;
  bool again_ = false;
  bool writing_ = false;
  bool cut_ = false;  // the client is gone
  bool ended_ = false;
  std::shared_ptr<Job> job_;
  uint64_t told_state_ = 0;
  uint64_t told_ = 0;
  Clock::time_point next_snapshot_;
  Clock::time_point next_heartbeat_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_WATCH_ENSEMBLE_JOB_H_
