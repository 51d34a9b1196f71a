#include "server/jobs/job.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "google/rpc/status.pb.h"
#include "server/jobs/job_message.h"
#include "server/jobs/job_name.h"
#include "server/jobs/job_state.h"
#include "server/observability/log.h"

namespace ballpiston::server {
namespace {

void LogEnd(const JobRecord& job, const std::string& state) {
  // A job without a start time ended before its first turn.
  const absl::Time begin = job.start_time.value_or(job.create_time);
  google::rpc::Status error;
  error.ParseFromString(job.error);
  Log(job.error.empty() ? Severity::kInfo : Severity::kWarning, absl::StrCat("job ", state),
      {{"job", JobName(job.id)},
       {"principal", job.principal},
       {"state", state},
       {"points", static_cast<double>(job.points_done)},
       {"samples", job.samples},
       {"processor_seconds", job.work},
       {"seconds", absl::ToDoubleSeconds(job.end_time.value_or(begin) - begin)},
       {"error", error.message()}});
}

void LogState(const JobRecord& job) {
  const std::string state = absl::AsciiStrToLower(StateName(job.state));
  if (HasEnded(job.state)) return LogEnd(job, state);
  Log(Severity::kInfo, absl::StrCat("job ", state),
      {{"job", JobName(job.id)}, {"principal", job.principal}, {"state", state}});
}

// Empty if it cannot be read.
v1::EnsembleSpec SpecOf(const std::string& bytes) {
  v1::EnsembleSpec spec;
  if (!spec.ParseFromString(bytes)) spec.Clear();
  return spec;
}

}  // namespace

Job::Job(JobRecord record, std::function<void()> on_state_change)
    : sequence_(record.sequence),
      id_(record.id),
      principal_(record.principal),
      restarts_(record.restarts),
      spec_(std::exchange(record.spec, {})),
      open_ended_(IsOpenEnded(SpecOf(spec_).target())),
      on_state_change_(std::move(on_state_change)),
      record_(std::move(record)) {}

JobState Job::state() const {
  MutexLock lock(mutex_);
  return record_.state;
}

JobRecord Job::Record() const {
  MutexLock lock(mutex_);
  return record_;
}

Job::View Job::Now() const {
  MutexLock lock(mutex_);
  const JobRecord record = record_;
  const v1::JobProgress progress = ProgressLocked();
  const uint64_t state_change = last_state_change_;
  lock.Unlock();
  View view = {JobMessage(record), state_change};
  *view.job.mutable_spec() = SpecOf(spec_);
  *view.job.mutable_progress() = progress;
  return view;
}

v1::JobProgress Job::Progress() const {
  MutexLock lock(mutex_);
  return ProgressLocked();
}

v1::JobProgress Job::ProgressLocked() const {
  v1::JobProgress progress;
  progress.set_points(static_cast<int32_t>(record_.points));
  progress.set_points_done(static_cast<int32_t>(record_.points_done));
  progress.set_samples(record_.samples);
  if (open_ended_) return progress;
  const double points = static_cast<double>(record_.points);
  const bool done = record_.points_done == record_.points;
  progress.set_fraction(done ? 1.0 : std::min(1.0, work_done_ / points));
  return progress;
}

bool Job::Enter(JobState state, absl::Time now, const std::string& error) {
  JobRecord record;
  {
    MutexLock lock(mutex_);
    if (!MayFollow(record_.state, state)) return false;
    record_.state = state;
    record_.error = error;
    if (state == v1::EnsembleJob::RUNNING) record_.start_time = now;
    if (HasEnded(state)) record_.end_time = now;
    last_state_change_ = last_change_ + 1;
    ++last_change_;
    record = record_;
  }
  LogState(record);
  if (on_state_change_) on_state_change_();
  return true;
}

uint64_t Job::AddSamples(double samples, double share_of_point) {
  MutexLock lock(mutex_);
  record_.samples += samples;
  work_done_ += share_of_point;
  return ++last_change_;
}

void Job::AddWork(double seconds) {
  MutexLock lock(mutex_);
  record_.work += seconds;
}

void Job::AddBytes(int64_t bytes) {
  MutexLock lock(mutex_);
  record_.bytes += bytes;
}

void Job::SetPinned(bool pinned) {
  MutexLock lock(mutex_);
  record_.pinned = pinned;
}

void Job::AddFinishedPoint(FinishedPoint point) {
  MutexLock lock(mutex_);
  ++record_.points_done;
  last_finished_ = point.number;
  recent_.push_back(std::move(point));
  if (recent_.size() > kRecentPoints) {
    last_forgotten_ = recent_.front().number;
    recent_.pop_front();
  }
  ++last_change_;
}

void Job::AddRestoredPoints(int64_t points, double samples, int64_t last) {
  MutexLock lock(mutex_);
  record_.points_done += points;
  record_.samples += samples;
  work_done_ += static_cast<double>(points);
  last_finished_ = last_forgotten_ = last;
  ++last_change_;
}

std::optional<std::vector<FinishedPoint>> Job::FinishedAfter(int64_t after, size_t limit) const {
  MutexLock lock(mutex_);
  if (after < last_forgotten_) return std::nullopt;
  const auto is_older = [](int64_t number, const FinishedPoint& p) { return number < p.number; };
  const auto first = std::upper_bound(recent_.begin(), recent_.end(), after, is_older);
  const auto left = static_cast<size_t>(recent_.end() - first);
  return std::vector<FinishedPoint>(first, first + static_cast<ptrdiff_t>(std::min(left, limit)));
}

}  // namespace ballpiston::server
