#include "server/jobs/job_snapshot.h"

#include <algorithm>

#include "absl/container/flat_hash_set.h"

namespace ballpiston::server {

void LeaveOutFinished(v1::StatisticsSnapshot& message) {
  absl::flat_hash_set<int32_t> finished;
  for (const v1::PointResult& point : message.finished_points()) finished.insert(point.index());
  auto& points = *message.mutable_points();
  const auto is_finished = [&](const v1::PointResult& point) {
    return finished.contains(point.index());
  };
  points.erase(std::remove_if(points.begin(), points.end(), is_finished), points.end());
}

std::shared_ptr<const JobSnapshot> SharedSnapshot::Get(uint64_t change,
                                                       std::chrono::milliseconds max_age,
                                                       Make make) {
  MutexLock lock(mutex_);
  const Clock::time_point now = Clock::now();
  const bool fits = last_ != nullptr && (last_->change >= change || now - made_ < max_age);
  if (!fits) {
    last_ = std::make_shared<const JobSnapshot>(make());
    made_ = now;
  }
  return last_;
}

}  // namespace ballpiston::server
