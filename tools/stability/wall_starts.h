// A ball alone, on a wall and about to leave it: anywhere, or aimed at where methods fail. The
// piston rests at its right wall, out of the way.
//
// Offsets from what is aimed at are +-10^-k, k = 3 ... 17, or exactly 0, one of 16 at random.
#ifndef BALLPISTON_TOOLS_STABILITY_WALL_STARTS_H_
#define BALLPISTON_TOOLS_STABILITY_WALL_STARTS_H_

#include <Eigen/Core>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "core/sampling/counter_random.h"

namespace ballpiston::stability {

double RandomOffset(CounterRandom& random);

PairState BallAlone(const PairGeometry& geometry, const Eigen::Vector2d& position,
                    const Eigen::Vector2d& direction);

// Of all wall points by the angle at the disc's centre; directions by the cosine law.
PairState AnywhereOnWall(const PairGeometry& geometry, CounterRandom& random);

// From a wall in sight of a tip to that tip, the direction off by an offset.
PairState AimedAtTip(const PairGeometry& geometry, CounterRandom& random);

// Past a disc in sight with impact parameter rho (1 - offset).
PairState AimedToGraze(const PairGeometry& geometry, CounterRandom& random);

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_WALL_STARTS_H_
