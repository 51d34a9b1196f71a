#include "server/jobs/job.h"

#include <algorithm>
#include <utility>

#include "server/convert/spec.h"

namespace ballpiston::server {

Job::Job(const JobRecord& record)
    : sequence_(record.sequence),
      id_(record.id),
      principal_(record.principal),
      restarts_(record.restarts),
      points_(record.points),
      open_ended_(
          IsOpenEnded(SpecFromBytes({record.spec.rest}).value_or(v1::EnsembleSpec()).target())),
      numbers_{.bytes = record.bytes} {}

LiveNumbers Job::Numbers() const {
  MutexLock lock(mutex_);
  return numbers_;
}

v1::JobProgress Job::Progress() const { return ProgressOf(points_, open_ended_, Numbers()); }

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

uint64_t Job::AddSamples(double samples, double share_of_point) {
  MutexLock lock(mutex_);
  numbers_.samples += samples;
  numbers_.points_computed += share_of_point;
  return ++last_change_;
}

void Job::AddWork(double seconds) {
  MutexLock lock(mutex_);
  numbers_.work += seconds;
}

void Job::AddBytes(int64_t bytes) {
  MutexLock lock(mutex_);
  numbers_.bytes += bytes;
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

void Job::AddRestoredPoints(int64_t points, double samples, int64_t last) {
  MutexLock lock(mutex_);
  numbers_.points_done += points;
  numbers_.samples += samples;
  numbers_.points_computed += static_cast<double>(points);
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
