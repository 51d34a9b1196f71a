// How many wall hits come between two collisions of ball and piston: what a sample will cost.
#ifndef BALLPISTON_CORE_EXPERIMENT_PREDICTED_HITS_H_
#define BALLPISTON_CORE_EXPERIMENT_PREDICTED_HITS_H_

#include "core/experiment/ensemble_spec.h"
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

// What a collision costs by a model that samples, for plans of blocks: events of the billiard, or
// as many as a jump and what is measured of it take as long as.
double EventsPerCollision(Model model, const PairGeometry& geometry);

// In a return to the collision surface at fixed energies.
PredictedHits HitsPerReturn(const PairGeometry& geometry, double epsilon);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_PREDICTED_HITS_H_
