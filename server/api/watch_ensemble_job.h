// WatchEnsembleJob: what is said of a job, in the frame of stream_reactor.h.
//
// What to say is decided when it can be said: of unfinished points only the newest state is told,
// and finished ones are read, from the job's memory or from the store, when their turn has come.
// Messages are made outside of the lock the workers need; watches of one job share what takes that
// lock (jobs/job_snapshot.h). Many watches are told less often, so that all of them together never
// take more than kSnapshotsPerSecond. A message with a large specification, of which a stalled
// reader would keep two copies, waits until those of its principal that are on their way leave room
// for it.
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

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "server/api/call.h"
#include "server/api/service_context.h"
#include "server/api/stream_reactor.h"

namespace ballpiston::server {

class WatchReactor : public StreamReactor<v1::WatchEnsembleJobResponse> {
 public:
  static WatchReactor* Start(ServiceContext& service, grpc::CallbackServerContext& context,
                             const absl::StatusOr<Call>& call,
                             const v1::WatchEnsembleJobRequest& request);

  void Look(Clock::time_point now) override;

 private:
  WatchReactor(ServiceContext& service, grpc::CallbackServerContext& context,
               const v1::WatchEnsembleJobRequest& request);

  absl::Status Tell() override;
  absl::Status CheckRights() const override;
  void ReleaseMessage() override { LeaveRoom(); }

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
  // With the token, and the time of the next heartbeat.
  void WriteUpdate() ABSL_LOCKS_EXCLUDED(mutex_);
  void WriteLastUpdate() ABSL_LOCKS_EXCLUDED(mutex_);

  const v1::WatchEnsembleJobRequest request_;

  // Of Advance.
  std::string id_;
  WatchedJob job_;
  std::string told_progress_;
  bool told_all_points_ = false;  // of a job that had ended before

  int64_t bytes_held_ ABSL_GUARDED_BY(mutex_) = 0;  // in TakeRoom

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
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_WATCH_ENSEMBLE_JOB_H_
