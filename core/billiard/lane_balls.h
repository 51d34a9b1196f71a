// Balls alone in the cell, flown in vector lanes by the flights of lane_flight-inl.h, six vectors
// at a time. For those who look at single hits: methods that are compared, tools, tests.
#ifndef BALLPISTON_CORE_BILLIARD_LANE_BALLS_H_
#define BALLPISTON_CORE_BILLIARD_LANE_BALLS_H_

#include <cstdint>
#include <span>

#include "core/billiard/lane_frame.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

struct LaneHit {
  LaneFrame frame;  // about to leave the wall that was hit
  double length;    // of the flight that ended there
  double x;         // of the ball in the cell, as the engine compares it with the piston's
};

// `hits` flights of each ball, in double or in single precision. `recorded` has n * starts.size()
// elements, where n divides `hits`: every (hits/n)-th hit of a ball is recorded, and the j-th
// record of ball i goes to [i * n + j]. So n = hits records all hits, n = 1 the last one, n = 0
// none.
void FlyLaneBalls(const PairGeometry& geometry, std::span<const LaneFrame> starts, uint64_t hits,
                  std::span<LaneHit> recorded);
void FlyLaneBallsSingle(const PairGeometry& geometry, std::span<const LaneFrame> starts,
                        uint64_t hits, std::span<LaneHit> recorded);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_BILLIARD_LANE_BALLS_H_
