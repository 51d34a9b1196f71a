#include "server/rpc/watch.h"

#include <algorithm>
#include <set>
#include <utility>

#include "ballpiston/storage/tokens.pb.h"
#include "server/convert/errors.h"
#include "server/host.h"
#include "server/rpc/request_check.h"

namespace ballpiston::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kMaxPoints = 100;  // of a kind in a message

// Limit for all watches together. A snapshot takes some 50 us, mostly in gRPC.
constexpr int64_t kSnapshotsPerSecond = 1000;

// The longest time until a watch sees that its client has gone.
constexpr std::chrono::seconds kLongestWait(1);

// Removes those points from the unfinished ones of a message that are also among its finished ones:
// they were finished after the snapshot was made.
void LeaveOutFinished(v1::StatisticsSnapshot& message) {
  std::set<int32_t> finished;
  for (const v1::PointResult& point : message.finished_points()) finished.insert(point.index());
  auto& points = *message.mutable_points();
  const auto is_finished = [&](const v1::PointResult& point) {
    return finished.contains(point.index());
  };
  points.erase(std::remove_if(points.begin(), points.end(), is_finished), points.end());
}

// One watch. Its functions Tell... send one message, or return false if there is nothing to send.
class Watch {
 public:
  Watch(JobBook& book, const WatchTiming& timing, const std::string& instance,
        const v1::WatchEnsembleJobRequest& request, WatchReader& reader)
      : book_(book),
        timing_(timing),
        instance_(instance),
        request_(request),
        reader_(reader),
        next_heartbeat_(SteadyNow() + timing.heartbeat) {}

  absl::Status Run() {
    absl::Status status = FindJob();
    while (status.ok() && !has_told_end_) {
      status = Proceed();
      if (status.ok()) status = TellNext();
    }
    return status;
  }

 private:
  absl::Status FindJob() {
    RequestCheck check;
    id_ = check.JobId("name", request_.name());
    if (!check.ok()) return check.status();
    absl::StatusOr<FoundJob> job = book_.Find(reader_.caller(), id_, Grid::kLeftOut);
    if (!job.ok()) return job.status();
    job_ = *std::move(job);
    ReadToken();
    return absl::OkStatus();
  }

  // An administrator who lost that role sees only their own jobs.
  absl::Status Proceed() {
    const absl::Status status = reader_.Proceed();
    const bool sees = reader_.caller().MaySee(job_.record.job.principal());
    return status.ok() && !sees ? JobNotFound(request_.name()) : status;
  }

  // Sends a message if there is one, else waits.
  absl::Status TellNext() {
    message_.Clear();
    const absl::StatusOr<bool> told = Tell();
    if (told.ok() && !*told) AwaitNews();
    return told.status();
  }

  // ---- when to send ----

  void AwaitNews() const {
    const Clock::time_point now = SteadyNow();
    const Clock::time_point next_look =
        next_snapshot_ > now ? next_snapshot_ : now + SnapshotInterval() / 4;
    job_.active->AwaitStateChange(
        told_state_,
        std::min({next_look, next_heartbeat_, reader_.next_check(), now + kLongestWait}));
  }

  bool IsSnapshotDue(Clock::time_point now) const {
    return now >= next_snapshot_ &&
           (job_.active->last_change() > told_ || job_.active->last_finished() > told_finished_);
  }

  // Whether at least one full message of finished points waits.
  bool IsBehind() const {
    return job_.active->last_finished() - told_finished_ >= static_cast<int64_t>(kMaxPoints);
  }

  Clock::duration SnapshotInterval() const {
    const std::chrono::milliseconds fair(reader_.watches() * 1000 / kSnapshotsPerSecond);
    return std::max(timing_.snapshot, fair);
  }

  // ---- messages ----

  // The job comes first.
  absl::StatusOr<bool> Tell() {
    if (job_.active == nullptr) return TellEnd(job_.record);
    absl::StatusOr<bool> told = TellState();
    if (told.ok() && !*told) told = TellSnapshot();
    if (told.ok() && !*told) told = TellHeartbeat();
    return told;
  }

  absl::StatusOr<bool> TellState() {
    const uint64_t change = job_.active->last_state_change();  // before the row, which may be newer
    if (change <= told_state_) return false;
    const absl::StatusOr<FoundJob> found = book_.Find(reader_.caller(), id_, Grid::kLeftOut);
    if (!found.ok()) return found.status();
    const JobRecord& record = found->record;
    const JobState state = record.job.state();
    if (HasEnded(state)) return TellEnd(record);
    told_state_ = change;
    if (std::exchange(told_as_, state) == state) return false;
    *message_.mutable_job() = book_.Message(record, job_.active.get());
    return Write();
  }

  // The points come from the store, which has all of them. The job in memory gets its last points
  // after the commit that shows its end to readers.
  absl::StatusOr<bool> TellEnd(const JobRecord& ended) {
    const absl::StatusOr<bool> told = TellPoints(ended, nullptr);
    if (!told.ok() || *told) return told;
    absl::StatusOr<v1::EnsembleJob> job = book_.Get(reader_.caller(), id_, Grid::kLeftOut);
    if (!job.ok()) return job.status();
    const int64_t done = job->progress().points_done();
    // A new watch of a job whose results had expired before has no points.
    if (!resumes_ && job_.record.job.results_expired()) told_finished_ = done;
    if (job->results_expired() && told_finished_ < done) return ResultsExpired(request_.name());
    *message_.mutable_job() = *std::move(job);
    has_told_end_ = true;
    return Write();
  }

  absl::StatusOr<bool> TellSnapshot() {
    const Clock::time_point now = SteadyNow();
    const bool is_due = IsSnapshotDue(now);
    if (!is_due && !IsBehind()) return false;
    if (is_due) {
      next_snapshot_ = now + SnapshotInterval();
      AddUnfinishedPoints(*message_.mutable_snapshot());
    }
    return TellPoints(job_.record, job_.active.get());
  }

  // An older snapshot may have a point as unfinished that was already sent as finished.
  void AddUnfinishedPoints(v1::StatisticsSnapshot& snapshot) {
    const auto shared = book_.Snapshot(*job_.active, timing_.snapshot, kMaxPoints);
    if (shared->finished < told_finished_) return;
    for (const JobSnapshot::Point& point : shared->points) {
      if (point.change > told_) *snapshot.add_points() = point.result;
    }
    told_ = std::max(told_, shared->change);
  }

  // Adds the next finished points to the message: those of `active`, or those of the store if
  // `active` is null. Sends the message if it has a point, or new progress of an active job.
  absl::StatusOr<bool> TellPoints(const JobRecord& record, const Job* active) {
    v1::StatisticsSnapshot& snapshot = *message_.mutable_snapshot();
    *snapshot.mutable_progress() =
        active != nullptr ? ProgressOf(record.job, active->Numbers()) : record.job.progress();
    auto finished = book_.FinishedAfter(record, active, told_finished_, kMaxPoints);
    if (!finished.ok()) return finished.status();
    for (FinishedPoint& point : *finished) {
      // Numbers have no gaps. Points that are missing have expired.
      if (point.number != told_finished_ + 1) return ResultsExpired(request_.name());
      *snapshot.add_finished_points() = std::move(point.result);
      told_finished_ = point.number;
    }
    LeaveOutFinished(snapshot);
    const std::string progress = snapshot.progress().SerializeAsString();
    const bool is_new = std::exchange(told_progress_, progress) != progress && active != nullptr;
    if (snapshot.points().empty() && finished->empty() && !is_new) return false;
    return Write();
  }

  absl::StatusOr<bool> TellHeartbeat() {
    if (SteadyNow() < next_heartbeat_) return false;
    message_.Clear();  // it may have a snapshot without news
    message_.mutable_heartbeat();
    return Write();
  }

  // Writes the message with its token. True, or CANCELLED.
  absl::StatusOr<bool> Write() {
    message_.set_resume_token(Token());
    if (!reader_.Write(message_)) return absl::CancelledError("the client is gone");
    next_heartbeat_ = SteadyNow() + timing_.heartbeat;
    return true;
  }

  // ---- resume tokens ----

  std::string Token() const {
    storage::ResumeToken token;
    token.set_job(id_);
    token.set_restarts(job_.record.restarts);
    token.set_finished(told_finished_);
    token.set_instance(instance_);
    token.set_change(told_);
    return TokenText(token);
  }

  void ReadToken() {
    const auto told = ParseToken<storage::ResumeToken>(request_.resume_token());
    if (!told || told->job() != id_ || told->restarts() != job_.record.restarts ||
        told->finished() < 0 || told->finished() > job_.last_finished()) {
      return;
    }
    resumes_ = true;
    told_finished_ = told->finished();
    const bool of_this_life = job_.active != nullptr && told->instance() == instance_;
    if (of_this_life && told->change() <= job_.active->last_change()) told_ = told->change();
  }

  JobBook& book_;
  const WatchTiming& timing_;
  const std::string& instance_;
  const v1::WatchEnsembleJobRequest& request_;
  WatchReader& reader_;
  v1::WatchEnsembleJobResponse message_;

  std::string id_;
  FoundJob job_;
  bool resumes_ = false;  // whether this watch resumes an earlier one
  std::string told_progress_;
  JobState told_as_ = v1::EnsembleJob::STATE_UNSPECIFIED;  // the last state that was sent
  bool has_told_end_ = false;
  uint64_t told_state_ = 0;  // numbers of the last changes that were sent
  uint64_t told_ = 0;
  int64_t told_finished_ = 0;  // number of the last finished point that was sent
  Clock::time_point next_snapshot_;
  Clock::time_point next_heartbeat_;
};

}  // namespace

absl::Status RunWatch(JobBook& book, const WatchTiming& timing, const std::string& instance,
                      const v1::WatchEnsembleJobRequest& request, WatchReader& reader) {
  return Watch(book, timing, instance, request, reader).Run();
}

}  // namespace ballpiston::server
