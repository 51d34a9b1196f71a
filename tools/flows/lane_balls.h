// Flies balls without a piston in vector lanes, several vectors at a time, with the flights of
// lane_flight-inl.h. Comparisons of methods, tools and tests use it, because they need single hits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/billiard/lane_frame.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

struct LaneHit {
  LaneFrame frame;  // the ball, about to leave the wall that it hit
  double length;    // of the flight that ended at the wall
  double x;         // abscissa of the ball in the cell; the engine compares it with the piston's
};

// The frames of balls that are on their walls.
std::vector<LaneFrame> OnTheirWalls(std::span<const PairState> starts);

// Flies each ball to its next `hits` hits. `recorded` is empty, or gets all of them: the j-th hit
// of ball i is recorded[i * hits + j].
using FlyLanes = void(const PairGeometry& geometry, std::span<const LaneFrame> starts,
                      uint64_t hits, std::span<LaneHit> recorded);
FlyLanes FlyLaneBalls;        // in double precision
FlyLanes FlyLaneBallsSingle;  // in single precision

}  // namespace ballpiston
