// A copy of a job's unfinished points at one moment, which its watches share (shared_copy.h).
#pragma once

#include <cstdint>
#include <vector>

#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/result.pb.h"

namespace ballpiston::server {

struct JobSnapshot {
  struct Point {
    uint64_t change = 0;     // the number of its last change
    v1::PointResult result;  // without histograms and curves
  };

  uint64_t change = 0;        // the job's last change before the snapshot
  int64_t finished = 0;       // the number of the last finished point then: none of `points` has it
                              // or a smaller one
  std::vector<Point> points;  // newest first
};

// Removes those points from the unfinished ones of a message that are also among its finished ones:
// they were finished after the snapshot was made.
void LeaveOutFinished(v1::StatisticsSnapshot& message);

}  // namespace ballpiston::server
