#include "server/jobs/job.h"

#include <algorithm>
#include <utility>

#include "server/jobs/job_message.h"
#include "server/jobs/job_state.h"

namespace ballpiston::server {

Job::Job(JobRecord record, std::function<void()> on_state_change)
    : sequence_(record.sequence),
      id_(record.id),
      principal_(record.principal),
      open_ended_(IsOpenEnded(JobMessage(record).spec().target())),
      on_state_change_(std::move(on_state_change)),
      record_(std::move(record)) {}

JobState Job::state() const {
  std::lock_guard lock(mutex_);
  return record_.state;
}

JobRecord Job::Record() const {
  std::lock_guard lock(mutex_);
  return record_;
}

v1::EnsembleJob Job::Message() const {
  std::unique_lock lock(mutex_);
  const JobRecord record = record_;
  const v1::JobProgress progress = ProgressLocked();
  lock.unlock();
  v1::EnsembleJob message = JobMessage(record);
  *message.mutable_progress() = progress;
  return message;
}

v1::JobProgress Job::Progress() const {
  std::lock_guard lock(mutex_);
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

uint64_t Job::last_change() const {
  std::lock_guard lock(mutex_);
  return last_change_;
}

uint64_t Job::last_state_change() const {
  std::lock_guard lock(mutex_);
  return last_state_change_;
}

bool Job::Enter(JobState state, absl::Time now, const std::string& error) {
  {
    std::lock_guard lock(mutex_);
    if (!MayFollow(record_.state, state)) return false;
    record_.state = state;
    record_.error = error;
    if (state == v1::EnsembleJob::RUNNING) record_.start_time = now;
    if (HasEnded(state)) record_.end_time = now;
    last_state_change_ = ++last_change_;
  }
  if (on_state_change_) on_state_change_();
  return true;
}

uint64_t Job::AddBlock(double samples, double share_of_point) {
  std::lock_guard lock(mutex_);
  record_.samples += samples;
  work_done_ += share_of_point;
  return ++last_change_;
}

void Job::AddWork(double seconds) {
  std::lock_guard lock(mutex_);
  record_.work += seconds;
}

uint64_t Job::AddFinishedPoint(FinishedPoint point) {
  std::lock_guard lock(mutex_);
  ++record_.points_done;
  RememberLocked(std::move(point));
  return last_change_;
}

uint64_t Job::AddRestoredPoints(int64_t points, double samples, std::vector<FinishedPoint> recent) {
  std::lock_guard lock(mutex_);
  record_.points_done += points;
  record_.samples += samples;
  work_done_ += static_cast<double>(points);
  for (FinishedPoint& point : recent) RememberLocked(std::move(point));
  return last_change_;
}

void Job::RememberLocked(FinishedPoint point) {
  recent_.push_front({++last_change_, std::move(point)});
  if (recent_.size() > kRecentPoints) recent_.pop_back();
}

std::vector<Job::Change> Job::FinishedSince(uint64_t number, size_t limit) const {
  std::lock_guard lock(mutex_);
  std::vector<Change> changes;
  for (const Change& change : recent_) {
    if (change.number <= number || changes.size() == limit) break;
    changes.push_back(change);
  }
  return changes;
}

}  // namespace ballpiston::server
