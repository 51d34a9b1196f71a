// Balls alone in the cell, flown in vector lanes by the flights of billiard/lane_flight-inl.h, six
// vectors at a time.
#ifndef BALLPISTON_CORE_METHOD_COMPARISON_LANE_BALLS_H_
#define BALLPISTON_CORE_METHOD_COMPARISON_LANE_BALLS_H_

#include <cstdint>
#include <span>

#include "core/billiard/lane_frame.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

struct LaneHit {
  LaneFrame frame;  // about to leave the wall that was hit
  double length;    // of the flight that ended there
};

// `hits` flights of each ball, in double or in single precision. With `recorded` not empty it has
// starts.size() * hits elements; hit k of ball i goes to [i * hits + k].
void FlyLaneBalls(const PairGeometry& geometry, std::span<const LaneFrame> starts, uint64_t hits,
                  std::span<LaneHit> recorded);
void FlyLaneBallsSingle(const PairGeometry& geometry, std::span<const LaneFrame> starts,
                        uint64_t hits, std::span<LaneHit> recorded);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_METHOD_COMPARISON_LANE_BALLS_H_
