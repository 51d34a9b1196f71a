// Positions uniform on the collision surface dGamma_bp, the paper's eq. dGc1: ball and piston at
// the same x, in the part of the ball's cell that the piston can reach.
//
// With t = tip - x in [0, delta], the cell's half-height there is
//   g(t) = t (lambda + t)/(1/2 + s),   s = sqrt(rho^2 - (lambda/2 + t)^2),
// and t has density proportional to g(t), y is uniform in (-g, g).
#ifndef BALLPISTON_CORE_SAMPLING_COLLISION_SURFACE_H_
#define BALLPISTON_CORE_SAMPLING_COLLISION_SURFACE_H_

#include <Eigen/Core>

#include "core/geometry/pair_geometry.h"
#include "core/sampling/counter_random.h"

namespace ballpiston {

// Half the height of the ball's cell at distance t from its right tip, 0 <= t <= PairDeltaBound.
double HalfHeight(const PairGeometry& geometry, double t);

// The ball's position; the piston's is its x.
Eigen::Vector2d UniformOnCollisionSurface(const PairGeometry& geometry, CounterRandom& random);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_SAMPLING_COLLISION_SURFACE_H_
