#include "server/api/watch_ensemble_job.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "server/api/request_check.h"
#include "server/api/resume_token.h"
#include "server/convert/errors.h"
#include "server/convert/point_result.h"
#include "server/convert/result_record.h"

namespace ballpiston::server {
namespace {

constexpr size_t kMaxPoints = 100;  // of a kind in a message

// Limit for all watches together. A snapshot takes some 50 us, mostly in gRPC.
constexpr int64_t kSnapshotsPerSecond = 1000;

// A message with a specification above kLargeSpec is large. kLargeMessages limits the bytes of
// large messages on their way to one principal.
constexpr size_t kLargeSpec = size_t{64} << 10;
constexpr int64_t kLargeMessages = int64_t{32} << 20;

// The time between two attempts to find room for a large message.
constexpr std::chrono::milliseconds kBetweenTries(200);

}  // namespace

WatchReactor* WatchReactor::Start(ServiceContext& service, grpc::CallbackServerContext& context,
                                  const absl::StatusOr<Call>& call,
                                  const v1::WatchEnsembleJobRequest& request) {
  const std::shared_ptr<WatchReactor> reactor(new WatchReactor(service, context, request));
  reactor->StreamReactor::Start(call);
  return reactor.get();
}

WatchReactor::WatchReactor(ServiceContext& service, grpc::CallbackServerContext& context,
                           const v1::WatchEnsembleJobRequest& request)
    : StreamReactor(service, context), request_(request), next_heartbeat_(next_check_) {}

// ---- when to send ----

void WatchReactor::Look(Clock::time_point now) {
  {
    MutexLock lock(mutex_);
    if (ended_ || (writing_ && now < next_check_)) return;
    const bool may_have_room = waits_for_room_ && now >= next_try_;
    const bool has_news = may_have_room || now >= next_check_ || HasNews(now);
    if (!has_news && now < next_heartbeat_ && !service_.draining) return;
  }
  Schedule();
}

bool WatchReactor::HasNews(Clock::time_point now) const {
  if (watched_ == nullptr) return false;
  const bool has_state = watched_->last_state_change() > told_state_ && !waits_for_room_;
  return has_state || (told_state_ > 0 && (IsBehind() || IsSnapshotDue(now)));
}

// Requires the lock, or a call from Advance, because only Advance changes these members.
bool WatchReactor::IsSnapshotDue(Clock::time_point now) const {
  return now >= next_snapshot_ &&
         (watched_->last_change() > told_ || watched_->last_finished() > told_finished_);
}

bool WatchReactor::IsBehind() const {
  return watched_->last_finished() - told_finished_ >= static_cast<int64_t>(kMaxPoints);
}

WatchReactor::Clock::duration WatchReactor::SnapshotInterval() const {
  const auto watches = static_cast<int64_t>(service_.watches.size());
  const std::chrono::milliseconds fair(watches * 1000 / kSnapshotsPerSecond);
  return std::max(service_.timing.snapshot, fair);
}

// ---- messages ----

absl::Status WatchReactor::Tell() {
  if (id_.empty()) {
    const absl::Status found = FindJob();
    if (!found.ok()) return found;
  }
  if (job_.active == nullptr) return TellOfEndedJob();
  absl::StatusOr<bool> told = TellState();
  if (told_state_ == 0) return told.status();  // the job comes first
  if (told.ok() && !*told) told = TellSnapshot();
  if (told.ok() && !*told) TellHeartbeat();
  return told.status();
}

absl::Status WatchReactor::CheckRights() const {
  const bool sees = id_.empty() || caller_.MaySee(job_.record.principal);
  return sees ? absl::OkStatus() : JobNotFound(request_.name());
}

bool WatchReactor::TakeRoom(size_t bytes) {
  const Clock::time_point now = Clock::now();
  if (waits_for_room_ && now < next_try_) return false;
  const auto held = static_cast<int64_t>(bytes);
  HeldCalls& messages = service_.executor.held_messages();
  const bool large = bytes > kLargeSpec;
  const bool taken = !large || messages.TryBegin(caller_.name, held, kLargeMessages);
  MutexLock lock(mutex_);
  waits_for_room_ = !taken;
  next_try_ = now + kBetweenTries;
  if (large && taken) bytes_held_ = held;
  return taken;
}

void WatchReactor::LeaveRoom() {
  int64_t held = 0;
  {
    MutexLock lock(mutex_);
    held = std::exchange(bytes_held_, 0);
  }
  if (held > 0) service_.executor.held_messages().End(caller_.name, held);
}

absl::Status WatchReactor::FindJob() {
  RequestCheck check;
  const std::string id = check.JobId("name", request_.name());
  if (!check.ok()) return check.status();
  absl::StatusOr<WatchedJob> job = service_.book.FindWatched(caller_, id);
  if (!job.ok()) return job.status();
  id_ = id;
  job_ = *std::move(job);
  MutexLock lock(mutex_);
  watched_ = job_.active;
  ReadToken(request_.resume_token(), job_.last_finished);
  return absl::OkStatus();
}

absl::StatusOr<bool> WatchReactor::TellState() {
  if (job_.active->last_state_change() <= told_state_) return false;
  const auto stored = service_.book.Stored(*job_.active);
  if (!stored.ok()) return stored.status();
  const JobRecord& record = (*stored)->record;
  if (HasEnded(record.state)) return TellEnd(record);
  const bool is_new = record.state != told_as_;
  if (is_new && !TakeRoom(static_cast<size_t>(record.spec_bytes))) return false;
  {
    MutexLock lock(mutex_);
    told_state_ = (*stored)->change;
  }
  if (!is_new) return false;
  told_as_ = record.state;
  *message_.mutable_job() = service_.book.Message(record, job_.active.get());
  WriteUpdate();
  return true;
}

// The points come from the store, which has all of them. The job in memory gets its last points
// after the commit that shows its end to readers.
absl::StatusOr<bool> WatchReactor::TellEnd(const JobRecord& ended) {
  const absl::StatusOr<bool> told =
      TellFinishedPoints(service_.book.Message(ended, nullptr).progress(), nullptr);
  if (!told.ok() || *told) return told;
  if (!TakeRoom(static_cast<size_t>(ended.spec_bytes))) return false;
  absl::StatusOr<v1::EnsembleJob> job = service_.book.Get(caller_, id_);
  if (!job.ok()) return job.status();
  // If the results expired since the job was found, some points may not have been sent.
  if (job->results_expired() && !job_.record.expired_time) return ResultsExpired(request_.name());
  *message_.mutable_job() = *std::move(job);
  WriteLastUpdate();
  return true;
}

absl::StatusOr<bool> WatchReactor::TellSnapshot() {
  const Clock::time_point now = Clock::now();
  if (!IsSnapshotDue(now)) {
    if (!IsBehind()) return false;
    return TellFinishedPoints(job_.active->Progress(), job_.active.get());
  }
  const auto shared = service_.book.Snapshot(*job_.active, service_.timing.snapshot, kMaxPoints);
  v1::StatisticsSnapshot& snapshot = *message_.mutable_snapshot();
  *snapshot.mutable_progress() = job_.active->Progress();
  // An older snapshot may have a point as unfinished that was already sent as finished.
  if (shared->finished >= told_finished_) {
    for (const JobSnapshot::Point& point : shared->points) {
      if (point.change > told_) *snapshot.add_points() = point.result;
    }
    MutexLock lock(mutex_);
    told_ = std::max(told_, shared->change);
  }
  const absl::StatusOr<bool> finished = AddFinishedPoints(job_.active.get());
  if (!finished.ok()) return finished;
  LeaveOutFinished(snapshot);
  {
    MutexLock lock(mutex_);
    next_snapshot_ = now + SnapshotInterval();
  }
  const std::string progress = snapshot.progress().SerializeAsString();
  const bool same_progress = std::exchange(told_progress_, progress) == progress;
  if (snapshot.points().empty() && !*finished && same_progress) return false;
  WriteUpdate();
  return true;
}

absl::StatusOr<bool> WatchReactor::TellFinishedPoints(const v1::JobProgress& progress,
                                                      const Job* active) {
  *message_.mutable_snapshot()->mutable_progress() = progress;
  const absl::StatusOr<bool> added = AddFinishedPoints(active);
  if (added.ok() && *added) WriteUpdate();
  return added;
}

absl::StatusOr<bool> WatchReactor::AddFinishedPoints(const Job* active) {
  const auto points =
      service_.book.FinishedAfter(job_.record.sequence, active, told_finished_, kMaxPoints);
  if (!points.ok()) return points.status();
  if (points->empty()) return false;
  for (const FinishedPoint& point : *points) {
    const absl::StatusOr<storage::Result> result = ResultFromBytes(*point.result);
    if (!result.ok()) return StoreFailure(result.status());
    *message_.mutable_snapshot()->add_finished_points() = PointResultMessage(*result);
  }
  MutexLock lock(mutex_);
  told_finished_ = points->back().number;
  return true;
}

absl::Status WatchReactor::TellOfEndedJob() {
  const absl::StatusOr<bool> told = TellEnd(job_.record);
  if (told.ok() && !*told) TellHeartbeat();
  return told.status();
}

void WatchReactor::TellHeartbeat() {
  if (Clock::now() < next_heartbeat_) return;
  message_.mutable_heartbeat();
  WriteUpdate();
}

// ---- resume tokens ----

std::string WatchReactor::Token() const {
  return ResumeTokenText({.job = id_,
                          .restarts = job_.record.restarts,
                          .finished = told_finished_,
                          .instance = service_.instance,
                          .change = told_});
}

void WatchReactor::ReadToken(const std::string& token, int64_t last_finished) {
  const std::optional<ResumeToken> told = ParseResumeToken(token);
  if (!told || told->job != id_ || told->restarts != job_.record.restarts ||
      told->finished > last_finished) {
    return;
  }
  told_finished_ = told->finished;
  const bool of_this_life = watched_ != nullptr && told->instance == service_.instance;
  if (of_this_life && told->change <= watched_->last_change()) told_ = told->change;
}

// ---- writing ----

void WatchReactor::WriteUpdate() {
  message_.set_resume_token(Token());
  {
    MutexLock lock(mutex_);
    next_heartbeat_ = Clock::now() + service_.timing.heartbeat;
  }
  Write();
}

void WatchReactor::WriteLastUpdate() {
  message_.set_resume_token(Token());
  WriteLastAndEnd();
}

}  // namespace ballpiston::server
