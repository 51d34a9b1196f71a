// The ball's flight through a piston that it does not feel: where the two really meet.
#ifndef BALLPISTON_TOOLS_STABILITY_GHOST_FLIGHT_H_
#define BALLPISTON_TOOLS_STABILITY_GHOST_FLIGHT_H_

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston::stability {

struct GhostFlight {
  double overlap;  // the most the ball was right of the piston on the way; negative: never
  double gap;      // by how much it is left of the piston at the end
};

// Over that time; the ball has to move.
GhostFlight FlyAsGhost(const PairGeometry& geometry, const PairState& from, double time);

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_GHOST_FLIGHT_H_
