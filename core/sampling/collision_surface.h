// Positions uniform on the collision surface dGamma_bp, the paper's eq. dGc1: ball and piston have
// the same x, in the part of the ball's cell that the piston can reach.
//
// The depth t = tip - x in [0, delta] has a density proportional to the cell's half-height at t,
// and y is uniform over the cell's height at t.
#pragma once

#include <Eigen/Core>

#include "core/geometry/pair_geometry.h"
#include "core/sampling/counter_random.h"

namespace ballpiston {

// The ball's position. The piston's position is the ball's x.
Eigen::Vector2d UniformOnCollisionSurface(const PairGeometry& geometry, CounterRandom& random);

}  // namespace ballpiston
