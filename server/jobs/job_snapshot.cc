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

}  // namespace ballpiston::server
