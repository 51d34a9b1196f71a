// WatchEnsembleJob: sends the state, the progress and the points of a job, in the frame of
// stream_reactor.h.
//
// The watch makes a message only when it can send it. It reads the state from the job's row after a
// change of state was committed. Of an unfinished point it sends the newest state. It reads
// finished points from the job's memory or from the store when it sends them. It makes messages
// without the lock that the workers need. A snapshot needs that lock; the watches of one job share
// their snapshots, and each row that is read (jobs/shared_copy.h). With many watches each gets
// snapshots less often, so that all of them together take at most kSnapshotsPerSecond. A stalled
// reader keeps two copies of a message. So a message with a large specification waits until the
// principal's messages on their way leave room for it.
//
// Properties of a watch and of the watches that resume it, each with a test of its name:
//   1. EachFinishedPointIsSentOnceInOrder: also over restarts, and before the terminal state.
//   2. StatesAndProgressNeverGoBack: progress within a life of the server.
//   3. TheTerminalStateIsSentOnce, last, and then OK. So the watch of a job that has ended begins
//      with the finished points that were not sent yet.
//
// The resume token names the job, the number of its restarts by other engines, and the last
// finished point that was sent. For unfinished points it also has the server process and the last
// change that was sent. The watch ignores some tokens and sends everything: a token of another job,
// of results that were dropped because another engine computes the job again, or of points that the
// store does not have. With a token of an earlier server process, it sends only the unfinished
// points again.
#pragma once

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
  // Each of these sends one message, or returns false if it has nothing to send now.
  absl::StatusOr<bool> TellState();
  absl::StatusOr<bool> TellSnapshot();
  // `active`: null to read the points from the store.
  absl::StatusOr<bool> TellFinishedPoints(const v1::JobProgress& progress, const Job* active);
  void TellHeartbeat();
  absl::Status TellOfEndedJob();
  // Sends the points that were not sent yet, then the job's end.
  absl::StatusOr<bool> TellEnd(const JobRecord& ended);

  // Reserves memory for a message with the job's specification, until the message is written. False
  // if there is no room now.
  bool TakeRoom(size_t bytes);
  void LeaveRoom();

  bool HasNews(Clock::time_point now) const;
  bool IsSnapshotDue(Clock::time_point now) const;
  bool IsBehind() const;  // at least one full message of finished points waits
  Clock::duration SnapshotInterval() const;
  absl::StatusOr<bool> AddFinishedPoints(const Job* active);  // to the message; false: none

  void ReadToken(const std::string& token, int64_t last_finished);
  std::string Token() const;
  // Adds the token to the message, writes it, and sets the time of the next heartbeat.
  void WriteUpdate() ABSL_LOCKS_EXCLUDED(mutex_);
  void WriteLastUpdate() ABSL_LOCKS_EXCLUDED(mutex_);

  const v1::WatchEnsembleJobRequest request_;

  // Only Advance uses these.
  std::string id_;
  WatchedJob job_;
  std::string told_progress_;
  JobState told_as_ = v1::EnsembleJob::STATE_UNSPECIFIED;  // the last state that was sent

  int64_t bytes_held_ ABSL_GUARDED_BY(mutex_) = 0;  // by TakeRoom

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
