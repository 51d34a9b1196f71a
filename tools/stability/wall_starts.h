// A ball alone on a wall, with a velocity away from it: anywhere, or aimed at a situation in which
// methods fail. The piston rests at its right wall, out of the ball's reach.
//
// The offset from the target is +-10^-k, k = 3 ... 17, or exactly 0: one of 16 values at random.
#pragma once

#include <Eigen/Core>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "core/sampling/counter_random.h"

namespace ballpiston::stability {

double RandomOffset(CounterRandom& random);

PairState BallAlone(const PairGeometry& geometry, const Eigen::Vector2d& position,
                    const Eigen::Vector2d& direction);

// A wall point, uniform in the angle at the disc's centre; the direction follows the cosine law.
PairState AnywhereOnWall(const PairGeometry& geometry, CounterRandom& random);

// From a wall in sight of a tip towards that tip; the direction has an offset.
PairState AimedAtTip(const PairGeometry& geometry, CounterRandom& random);

// Past a disc in sight with impact parameter rho (1 - offset).
PairState AimedToGraze(const PairGeometry& geometry, CounterRandom& random);

}  // namespace ballpiston::stability
