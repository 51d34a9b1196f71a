// WatchEnsembleJob: one write outstanding, and the next message made when it is done.
//
// What to say is decided when it can be said, so a slow reader costs one message of memory and
// nobody's time: of unfinished points only the newest state is told, and finished ones are read,
// from the job's memory or from the store, when their turn has come. Messages are made on the
// threads for streams, never on gRPC's, and outside of the lock the workers need; watches of one
// job share what takes that lock (jobs/job_snapshot.h). Many watches are told less often, so that
// all of them together never take more than kSnapshotsPerSecond. A message with a large
// specification, of which a stalled reader would keep two copies, waits until those of its
// principal that are on their way leave room for it.
//
// Once in a heartbeat's time the credentials are looked up again: a watch ends when they do.
//
// Properties, over a watch and those that go on with its tokens, each with a test of its name:
//   1. EachFinishedPointIsToldOnceInOrder: also over restarts, and before the terminal state.
//   2. StatesAndProgressNeverGoBack: progress within a life of the server.
//   3. TheTerminalStateIsToldOnce, last, and then OK. So the watch of a job that has ended begins
//      with the finished points, if there are any left to tell.
//
// The resume token names the job, the engine that computes it, and the last finished point told;
// and, for the unfinished ones, the server's life and the last change told. A token of another job,
// of results that were dropped because another engine computes the job anew, or of points that the
// store does not have, is as good as none: the watch begins with everything. Of another life, only
// the unfinished points are told again.
#ifndef BALLPISTON_SERVER_API_WATCH_ENSEMBLE_JOB_H_
#define BALLPISTON_SERVER_API_WATCH_ENSEMBLE_JOB_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "grpcpp/support/server_callback.h"
#include "server/api/call.h"
#include "server/api/service_context.h"
#include "server/mutex.h"

namespace ballpiston::server {

class WatchReactor : public grpc::ServerWriteReactor<v1::WatchEnsembleJobResponse>,
                     public Watch,
                     public std::enable_shared_from_this<WatchReactor> {
 public:
  // Owns itself until gRPC is done with it. A call that was not admitted ends at once.
  //   RESOURCE_EXHAUSTED  TOO_MANY_STREAMS
  static WatchReactor* Start(ServiceContext& service, grpc::CallbackServerContext& context,
                             const absl::StatusOr<Call>& call,
                             const v1::WatchEnsembleJobRequest& request);

  void Look(std::chrono::steady_clock::time_point now) override;

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  using Clock = std::chrono::steady_clock;

  WatchReactor(ServiceContext& service, grpc::CallbackServerContext& context,
               const v1::WatchEnsembleJobRequest& request);

  // Has Advance run, once more if it is running now. At most one Advance runs at a time, and all
  // writes and the end come from it.
  void Schedule() ABSL_LOCKS_EXCLUDED(mutex_);
  void Advance();
  absl::Status TellWhatIsNew();

  // OK while the caller may still watch the job, and while it is not yet time to ask again.
  absl::Status CheckCaller();
  void AbandonWrite(const absl::Status& why) ABSL_LOCKS_EXCLUDED(mutex_);

  absl::Status FindJob();
  // Each of these is one message, or false if there is nothing of the kind to tell now.
  absl::StatusOr<bool> TellState();
  absl::StatusOr<bool> TellSnapshot();
  absl::StatusOr<bool> TellFinishedPoints(const v1::JobProgress& progress);
  void TellHeartbeat();
  absl::Status TellOfEndedJob();

  // Room for a job's message with its specification, until it is written. False: not now.
  bool TakeRoom(size_t bytes);
  void LeaveRoom();

  bool HasNews(Clock::time_point now) const;
  bool IsSnapshotDue(Clock::time_point now) const;
  bool IsBehind() const;  // by a whole message of finished points
  Clock::duration SnapshotInterval() const;
  absl::StatusOr<bool> AddFinishedPoints();  // to the message: whether there were any

  void ReadToken(const std::string& token, int64_t last_finished);
  std::string Token() const;
  void Write() ABSL_LOCKS_EXCLUDED(mutex_);
  void WriteLastAndEnd() ABSL_LOCKS_EXCLUDED(mutex_);
  void End(const absl::Status& status) ABSL_LOCKS_EXCLUDED(mutex_);

  ServiceContext& service_;
  grpc::CallbackServerContext& context_;  // valid until the end is sent
  const v1::WatchEnsembleJobRequest request_;
  Principal caller_;                    // its role may change
  const std::shared_ptr<void> active_;  // for Activity
  std::shared_ptr<WatchReactor> self_;

  // Of Advance, and of gRPC during a write.
  std::string id_;
  WatchedJob job_;
  v1::WatchEnsembleJobResponse message_;
  std::string told_progress_;
  bool told_all_points_ = false;  // of a job that had ended before

  Mutex mutex_;  // never held while gRPC is called
  bool scheduled_ ABSL_GUARDED_BY(mutex_) = false;
  bool again_ ABSL_GUARDED_BY(mutex_) = false;
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool cut_ ABSL_GUARDED_BY(mutex_) = false;        // the client is gone
  absl::Status abandoned_ ABSL_GUARDED_BY(mutex_);  // why the write is not waited for
  int64_t bytes_held_ ABSL_GUARDED_BY(mutex_) = 0;  // in TakeRoom
  bool ended_ ABSL_GUARDED_BY(mutex_) = false;

  // Only Advance changes these, and it holds the lock then. So Advance may read them without the
  // lock; other functions need it.
  bool waits_for_room_ = false;
  std::shared_ptr<Job> watched_;  // job_.active
  uint64_t told_state_ = 0;       // numbers of changes
  uint64_t told_ = 0;
  int64_t told_finished_ = 0;   // the number of a point
  Clock::time_point next_try_;  // to find room
  Clock::time_point next_snapshot_;
  Clock::time_point next_heartbeat_;
  Clock::time_point next_check_;  // of the credentials
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_WATCH_ENSEMBLE_JOB_H_
