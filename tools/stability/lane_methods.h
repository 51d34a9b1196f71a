// Balls in vector lanes, moved by the engine's own flight.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/lane_balls.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

using FlyLanes = void (*)(const PairGeometry& geometry, std::span<const LaneFrame> starts,
                          uint64_t hits, std::span<LaneHit> recorded);

Failures FlyInLanesWatched(FlyLanes fly, double epsilon, const PairGeometry& geometry,
                           std::span<const PairState> starts, uint64_t hits);

std::vector<double> ThereAndBackInLanes(FlyLanes fly, const PairGeometry& geometry,
                                        std::span<const PairState> starts, uint64_t hits);

// |u|^2 - 1 of a ball in the lanes.
double SquaredLengthError(const LaneFrame& frame);

}  // namespace ballpiston::stability
