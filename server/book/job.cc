#include "server/book/job.h"

#include <utility>

#include "server/host.h"

namespace ballpiston::server {
namespace {

JobRecord WithoutSpec(JobRecord row) {
  row.job.clear_spec();
  return row;
}

}  // namespace

Job::Job(JobRecord row)
    : row_(WithoutSpec(std::move(row))), numbers_{.bytes = StoredBytesOf(row_.job)} {}

JobNumbers Job::Numbers() const {
  MutexLock lock(mutex_);
  return numbers_;
}

void Job::NoteStateChange() {
  MutexLock lock(mutex_);
  last_state_change_ = ++last_change_;
  state_changed_.NotifyAll();
}

void Job::AwaitStateChange(uint64_t after, std::chrono::steady_clock::time_point until) {
  MutexLock lock(mutex_);
  while (!stopping_ && last_state_change_ <= after && state_changed_.WaitUntil(mutex_, until)) {
  }
}

void Job::StopWaiting() {
  MutexLock lock(mutex_);
  stopping_ = true;
  state_changed_.NotifyAll();
}

uint64_t Job::Add(const JobNumbers& more) {
  MutexLock lock(mutex_);
  numbers_.Add(more);
  return ++last_change_;
}

void Job::AddFinishedPoint(int64_t number) {
  MutexLock lock(mutex_);
  ++numbers_.points_done;
  last_finished_ = number;
  ++last_change_;
}

void Job::AddRestoredPoints(const std::vector<PointSize>& points) {
  MutexLock lock(mutex_);
  for (const PointSize& point : points) {
    numbers_.Add(
        {.points_done = 1, .samples = point.samples, .bytes = point.bytes, .points_computed = 1});
  }
  last_finished_ = numbers_.points_done;
  ++last_change_;
}

std::shared_ptr<const JobSnapshot> Job::Snapshot(std::chrono::milliseconds max_age,
                                                 absl::FunctionRef<JobSnapshot()> make) {
  const uint64_t change = last_change_;
  MutexLock lock(snapshot_mutex_);
  const auto now = SteadyNow();
  const bool fits =
      snapshot_ != nullptr && (snapshot_->change >= change || now - snapshot_time_ < max_age);
  if (fits) return snapshot_;
  snapshot_ = std::make_shared<const JobSnapshot>(make());
  snapshot_time_ = now;
  return snapshot_;
}

}  // namespace ballpiston::server
