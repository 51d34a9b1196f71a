// Balls alone in the cell, flown in vector lanes as the engine flies them: for tests and the
// stability table.
#ifndef BALLPISTON_TESTS_ORACLE_LANE_BALLS_H_
#define BALLPISTON_TESTS_ORACLE_LANE_BALLS_H_

#include <cstdint>
#include <span>

#include "core/billiard/lane_frame.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston::oracle {

struct LaneBall {
  LaneFrame frame;      // on a wall, about to leave it
  double length = 0;    // of the last flight
  double path = 0;      // of all flights so far
  double shortest = 0;  // least length of all flights of the call
  double x = 0;         // in the cell, as the engine sees it
};

// Each ball makes `flights` flights, in the instruction set that Highway has chosen.
void FlyInLanes(const PairGeometry& geometry, uint64_t flights, std::span<LaneBall> balls);
void FlyInLanesSingle(const PairGeometry& geometry, uint64_t flights, std::span<LaneBall> balls);

}  // namespace ballpiston::oracle

#endif  // BALLPISTON_TESTS_ORACLE_LANE_BALLS_H_
