// Mean number of wall hits between two collisions of ball and piston. It predicts the cost of a
// sample.
#pragma once

#include "core/geometry/pair_geometry.h"

namespace ballpiston {

struct PredictedHits {
  double ball_wall;
  double piston_wall;

  // With the collision itself.
  double Events() const { return 1 + ball_wall + piston_wall; }
};

// In equilibrium.
PredictedHits HitsPerCollision(const PairGeometry& geometry);

// In a return to the collision surface at fixed energies.
PredictedHits HitsPerReturn(const PairGeometry& geometry, double epsilon);

}  // namespace ballpiston
