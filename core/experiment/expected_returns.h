// Predictions for returns to the collision surface, by closed forms. The number of wall hits before
// a return decides the cost of a sample. The number of long returns decides its standard error.
//
// With a slow piston (epsilon -> 0) or a slow ball (epsilon -> 1/2) most returns are short, as if
// the slow body rested. A few very long returns dominate the mean: the piston goes to its far wall
// and back, or the ball crosses the cell. The closed forms give their share of the mean, and from
// it the expected number of long returns in a sample. If this number is small, the scatter of the
// sample does not contain them, and no error is given.
//
// At exactly epsilon = 0 there are no long returns, but the variance is infinite: a start at depth
// t below the tip returns after a time of order 1/(t (lambda + t)), with density t (lambda + t).
#pragma once

#include "core/geometry/pair_geometry.h"

namespace ballpiston {

// Mean numbers of wall hits between two collisions of ball and piston.
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

// Expected number of long returns in one sample; about 1 or more if they are not rare. 0 at
// epsilon = 0: no number of samples is enough. Infinite at epsilon = 1/2, where the ball rests and
// return times are bounded.
double LongReturnsPerSample(const PairGeometry& geometry, double epsilon);

// About the share of orbits, started with uniform positions at this energy, that meet within
// `time`, some mean free times. While the slow body rests, only the share of the volume that can be
// reached meets; the slow body reaches the rest in the time of its round trip. Almost 1 unless one
// body is slow. It decides whether a sample contains enough orbits that meet, so a rough value is
// enough.
double ShareThatMeets(const PairGeometry& geometry, double epsilon, double time);

}  // namespace ballpiston
