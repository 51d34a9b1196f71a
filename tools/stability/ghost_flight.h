// The flight of a ball that passes through the piston. It shows where the two really collide.
#pragma once

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston::stability {

struct GhostFlight {
  double overlap;  // the largest distance of the ball to the right of the piston; negative: never
  double gap;      // the distance of the ball to the left of the piston at the end
};

// Moves the ball for this time. The ball must not be at rest.
GhostFlight FlyAsGhost(const PairGeometry& geometry, const PairState& from, double time);

}  // namespace ballpiston::stability
