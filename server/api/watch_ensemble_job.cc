// WatchEnsembleJob: sends the state, the progress and the points of a job.
//
// The watch makes a message when its reader has taken the previous one. It reads the state from the
// job's row after a change of state was committed. Of an unfinished point it sends the newest
// state. It reads finished points from the job's memory or from the store when it sends them. A
// snapshot needs the lock that the workers need; the watches of one job share their snapshots, and
// each row that is read (jobs/shared_copy.h). With many watches each gets snapshots less often, so
// that all of them together take at most kSnapshotsPerSecond.
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
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "server/api/methods.h"
#include "server/api/request_check.h"
#include "server/api/resume_token.h"
#include "server/convert/errors.h"
#include "server/convert/point_result.h"

namespace ballpiston::server {
namespace {

using Clock = Stream::Clock;

constexpr size_t kMaxPoints = 100;  // of a kind in a message

// Limit for all watches together. A snapshot takes some 50 us, mostly in gRPC.
constexpr int64_t kSnapshotsPerSecond = 1000;

// The longest time until a watch sees that its client has gone.
constexpr std::chrono::seconds kLongestWait(1);

// One watch. Its functions Tell... send one message, or return false if there is nothing to send.
class Watch {
 public:
  Watch(ServiceContext& service, Stream& stream, const v1::WatchEnsembleJobRequest& request,
        grpc::ServerWriter<v1::WatchEnsembleJobResponse>& writer)
      : service_(service),
        stream_(stream),
        request_(request),
        writer_(writer),
        next_heartbeat_(Clock::now() + service.timing.heartbeat) {}

  absl::Status Run() {
    absl::Status status = FindJob();
    while (status.ok() && !has_told_end_) {
      status = Proceed();
      if (status.ok()) status = TellNext();
    }
    return status;
  }

 private:
  absl::Status FindJob();

  // An administrator who lost that role sees only their own jobs.
  absl::Status Proceed() {
    const absl::Status status = stream_.Proceed();
    const bool sees = stream_.caller().MaySee(job_.record.principal);
    return status.ok() && !sees ? JobNotFound(request_.name()) : status;
  }

  // Sends a message if there is one, else waits.
  absl::Status TellNext() {
    message_.Clear();
    const absl::StatusOr<bool> told = Tell();
    if (told.ok() && !*told) AwaitNews();
    return told.status();
  }

  absl::StatusOr<bool> Tell();
  absl::StatusOr<bool> TellState();
  absl::StatusOr<bool> TellSnapshot();
  absl::StatusOr<bool> TellFinishedPoints(const v1::JobProgress& progress, const Job* active);
  absl::StatusOr<bool> TellHeartbeat();
  absl::StatusOr<bool> TellEnd(const JobRecord& ended);

  void AwaitNews() const;
  bool IsSnapshotDue(Clock::time_point now) const;
  bool IsBehind() const;
  Clock::duration SnapshotInterval() const;

  // Adds to the message the next finished points: of `active`, or if it is null of the store.
  // False: there are none.
  absl::StatusOr<bool> AddFinishedPoints(const Job* active);
  void AddUnfinishedPoints(v1::StatisticsSnapshot& snapshot);

  void ReadToken();
  std::string Token() const;
  // Writes the message with its token. True, or CANCELLED.
  absl::StatusOr<bool> Write();

  ServiceContext& service_;
  Stream& stream_;
  const v1::WatchEnsembleJobRequest& request_;
  grpc::ServerWriter<v1::WatchEnsembleJobResponse>& writer_;
  v1::WatchEnsembleJobResponse message_;

  std::string id_;
  WatchedJob job_;
  std::string told_progress_;
  JobState told_as_ = v1::EnsembleJob::STATE_UNSPECIFIED;  // the last state that was sent
  bool has_told_end_ = false;
  uint64_t told_state_ = 0;  // numbers of changes
  uint64_t told_ = 0;
  int64_t told_finished_ = 0;  // the number of a point
  Clock::time_point next_snapshot_;
  Clock::time_point next_heartbeat_;
};

absl::Status Watch::FindJob() {
  RequestCheck check;
  id_ = check.JobId("name", request_.name());
  if (!check.ok()) return check.status();
  absl::StatusOr<WatchedJob> job = service_.book.FindWatched(stream_.caller(), id_);
  if (!job.ok()) return job.status();
  job_ = *std::move(job);
  ReadToken();
  return absl::OkStatus();
}

// ---- when to send ----

void Watch::AwaitNews() const {
  const Clock::time_point now = Clock::now();
  const Clock::time_point next_look =
      next_snapshot_ > now ? next_snapshot_ : now + SnapshotInterval() / 4;
  job_.active->AwaitStateChange(told_state_, std::min({next_look, next_heartbeat_,
                                                       stream_.next_check(), now + kLongestWait}));
}

bool Watch::IsSnapshotDue(Clock::time_point now) const {
  return now >= next_snapshot_ &&
         (job_.active->last_change() > told_ || job_.active->last_finished() > told_finished_);
}

// Whether at least one full message of finished points waits.
bool Watch::IsBehind() const {
  return job_.active->last_finished() - told_finished_ >= static_cast<int64_t>(kMaxPoints);
}

Clock::duration Watch::SnapshotInterval() const {
  const auto watches = static_cast<int64_t>(service_.streams.size());
  const std::chrono::milliseconds fair(watches * 1000 / kSnapshotsPerSecond);
  return std::max(service_.timing.snapshot, fair);
}

// ---- messages ----

// The job comes first.
absl::StatusOr<bool> Watch::Tell() {
  if (job_.active == nullptr) return TellEnd(job_.record);
  absl::StatusOr<bool> told = TellState();
  if (told.ok() && !*told) told = TellSnapshot();
  if (told.ok() && !*told) told = TellHeartbeat();
  return told;
}

absl::StatusOr<bool> Watch::TellState() {
  if (job_.active->last_state_change() <= told_state_) return false;
  const auto stored = service_.book.Stored(*job_.active);
  if (!stored.ok()) return stored.status();
  const JobRecord& record = (*stored)->record;
  if (HasEnded(record.state)) return TellEnd(record);
  told_state_ = (*stored)->change;
  if (std::exchange(told_as_, record.state) == record.state) return false;
  *message_.mutable_job() = service_.book.Message(record, job_.active.get());
  return Write();
}

// The points come from the store, which has all of them. The job in memory gets its last points
// after the commit that shows its end to readers.
absl::StatusOr<bool> Watch::TellEnd(const JobRecord& ended) {
  const absl::StatusOr<bool> told =
      TellFinishedPoints(service_.book.Message(ended, nullptr).progress(), nullptr);
  if (!told.ok() || *told) return told;
  absl::StatusOr<v1::EnsembleJob> job = service_.book.Get(stream_.caller(), id_, Grid::kLeftOut);
  if (!job.ok()) return job.status();
  // If the results expired since the job was found, some points may not have been sent.
  if (job->results_expired() && !job_.record.expired_time) return ResultsExpired(request_.name());
  *message_.mutable_job() = *std::move(job);
  has_told_end_ = true;
  return Write();
}

absl::StatusOr<bool> Watch::TellSnapshot() {
  const Clock::time_point now = Clock::now();
  if (!IsSnapshotDue(now)) {
    if (!IsBehind()) return false;
    return TellFinishedPoints(job_.active->Progress(), job_.active.get());
  }
  next_snapshot_ = now + SnapshotInterval();
  v1::StatisticsSnapshot& snapshot = *message_.mutable_snapshot();
  *snapshot.mutable_progress() = job_.active->Progress();
  AddUnfinishedPoints(snapshot);
  const absl::StatusOr<bool> finished = AddFinishedPoints(job_.active.get());
  if (!finished.ok()) return finished;
  LeaveOutFinished(snapshot);
  const std::string progress = snapshot.progress().SerializeAsString();
  const bool same_progress = std::exchange(told_progress_, progress) == progress;
  if (snapshot.points().empty() && !*finished && same_progress) return false;
  return Write();
}

// An older snapshot may have a point as unfinished that was already sent as finished.
void Watch::AddUnfinishedPoints(v1::StatisticsSnapshot& snapshot) {
  const auto shared = service_.book.Snapshot(*job_.active, service_.timing.snapshot, kMaxPoints);
  if (shared->finished < told_finished_) return;
  for (const JobSnapshot::Point& point : shared->points) {
    if (point.change > told_) *snapshot.add_points() = point.result;
  }
  told_ = std::max(told_, shared->change);
}

absl::StatusOr<bool> Watch::TellFinishedPoints(const v1::JobProgress& progress, const Job* active) {
  *message_.mutable_snapshot()->mutable_progress() = progress;
  const absl::StatusOr<bool> added = AddFinishedPoints(active);
  return added.ok() && *added ? Write() : added;
}

absl::StatusOr<bool> Watch::AddFinishedPoints(const Job* active) {
  const auto points =
      service_.book.FinishedAfter(job_.record.sequence, active, told_finished_, kMaxPoints);
  if (!points.ok()) return points.status();
  if (points->empty()) return false;
  for (const FinishedPoint& point : *points) {
    absl::StatusOr<v1::PointResult> result = ResultFromBytes(*point.result);
    if (!result.ok()) return StoreFailure(result.status());
    *message_.mutable_snapshot()->add_finished_points() = *std::move(result);
  }
  told_finished_ = points->back().number;
  return true;
}

absl::StatusOr<bool> Watch::TellHeartbeat() {
  if (Clock::now() < next_heartbeat_) return false;
  message_.Clear();  // it may have a snapshot without news
  message_.mutable_heartbeat();
  return Write();
}

absl::StatusOr<bool> Watch::Write() {
  message_.set_resume_token(Token());
  if (!writer_.Write(message_)) return absl::CancelledError("the client is gone");
  next_heartbeat_ = Clock::now() + service_.timing.heartbeat;
  return true;
}

// ---- resume tokens ----

std::string Watch::Token() const {
  return ResumeTokenText({.job = id_,
                          .restarts = job_.record.restarts,
                          .finished = told_finished_,
                          .instance = service_.instance,
                          .change = told_});
}

void Watch::ReadToken() {
  const std::optional<ResumeToken> told = ParseResumeToken(request_.resume_token());
  if (!told || told->job != id_ || told->restarts != job_.record.restarts ||
      told->finished > job_.last_finished) {
    return;
  }
  told_finished_ = told->finished;
  const bool of_this_life = job_.active != nullptr && told->instance == service_.instance;
  if (of_this_life && told->change <= job_.active->last_change()) told_ = told->change;
}

}  // namespace

absl::Status WatchEnsembleJob(ServiceContext& service, Stream& stream,
                              const v1::WatchEnsembleJobRequest& request,
                              grpc::ServerWriter<v1::WatchEnsembleJobResponse>& writer) {
  return Watch(service, stream, request, writer).Run();
}

}  // namespace ballpiston::server
