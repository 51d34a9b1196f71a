#include "core/sampling/collision_surface.h"

#include <algorithm>

namespace ballpiston {
namespace {

// Draws from the density proportional to t (lambda + t) on [0, delta], a mixture of the densities t
// and t^2. These are the densities of the largest of two and of three uniform numbers.
double ProposeDepth(const PairGeometry& geometry, CounterRandom& random) {
  const double linear = geometry.lambda() / 2, quadratic = geometry.delta() / 3;
  double largest = std::max(random.Uniform(), random.Uniform());
  if (random.Uniform() * (linear + quadratic) > linear)
    largest = std::max(largest, random.Uniform());
  return geometry.delta() * largest;
}

}  // namespace

Eigen::Vector2d UniformOnCollisionSurface(const PairGeometry& geometry, CounterRandom& random) {
  // 1/(1/2 + s) grows with t, so its value at delta is a bound. At least half of the proposals are
  // accepted.
  const double smallest = 0.5 + geometry.CentreToArc(geometry.delta());
  for (;;) {
    const double t = ProposeDepth(geometry, random);
    if (random.Uniform() * (0.5 + geometry.CentreToArc(t)) > smallest) continue;
    return {geometry.tip() - t, (2 * random.Uniform() - 1) * geometry.HalfHeight(t)};
  }
}

}  // namespace ballpiston
