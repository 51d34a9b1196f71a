// Positions uniform on the collision surface dGamma_bp, the paper's eq. dGc1: ball and piston at
// the same x, in the part of the ball's cell that the piston can reach.
//
// The depth t = tip - x in [0, delta] has density proportional to the cell's half-height there, and
// y is uniform within it.
#ifndef BALLPISTON_CORE_SAMPLING_COLLISION_SURFACE_H_
#define BALLPISTON_CORE_SAMPLING_COLLISION_SURFACE_H_

#include <Eigen/Core>

#include "core/geometry/pair_geometry.h"
#include "core/sampling/counter_random.h"

namespace ballpiston {

// The ball's position; the piston's is its x.
Eigen::Vector2d UniformOnCollisionSurface(const PairGeometry& geometry, CounterRandom& random);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_SAMPLING_COLLISION_SURFACE_H_
