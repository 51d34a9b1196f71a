#include "server/book/job.h"

#include <algorithm>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "server/book/job_message.h"
#include "server/convert/spec.h"
#include "server/host.h"

namespace ballpiston::server {

namespace {

JobRecord WithoutSpec(JobRecord row) {
  row.spec = {};
  return row;
}

}  // namespace

void LeaveOutFinished(v1::StatisticsSnapshot& message) {
  absl::flat_hash_set<int32_t> finished;
  for (const v1::PointResult& point : message.finished_points()) finished.insert(point.index());
  auto& points = *message.mutable_points();
  const auto is_finished = [&](const v1::PointResult& point) {
    return finished.contains(point.index());
  };
  points.erase(std::remove_if(points.begin(), points.end(), is_finished), points.end());
}

Job::Job(JobRecord row)
    : open_ended_(
          IsOpenEnded(SpecFromBytes({row.spec.rest}).value_or(v1::EnsembleSpec()).target())),
      row_(WithoutSpec(std::move(row))),
      numbers_(row_.numbers) {}

JobNumbers Job::Numbers() const {
  MutexLock lock(mutex_);
  return numbers_;
}

v1::JobProgress Job::Progress() const { return ProgressOf(row_.points, open_ended_, Numbers()); }

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

void Job::AddFinishedPoint(FinishedPoint point) {
  MutexLock lock(mutex_);
  ++numbers_.points_done;
  last_finished_ = point.number;
  recent_.push_back(std::move(point));
  if (recent_.size() > kRecentPoints) {
    last_forgotten_ = recent_.front().number;
    recent_.pop_front();
  }
  ++last_change_;
}

void Job::AddRestoredPoints(const std::vector<PointSize>& points) {
  MutexLock lock(mutex_);
  for (const PointSize& point : points) {
    numbers_.Add(
        {.points_done = 1, .samples = point.samples, .bytes = point.bytes, .points_computed = 1});
  }
  last_finished_ = last_forgotten_ = numbers_.points_done;
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
