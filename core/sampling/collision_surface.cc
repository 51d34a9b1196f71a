#include "core/sampling/collision_surface.h"

#include <algorithm>
#include <cmath>

namespace ballpiston {
namespace {

// s(t) = sqrt(rho^2 - (lambda/2 + t)^2), in the form that keeps its digits for lambda -> 0.
double CentreToArc(const PairGeometry& geometry, double t) {
  const double square = (1 - 2 * t) * (1 + 2 * t) - 4 * t * geometry.lambda();
  return std::sqrt(std::max(square, 0.0)) / 2;
}

// Density proportional to t (lambda + t) on [0, delta]: a mixture of densities t and t^2, which
// are those of the larger of two and of the largest of three uniform numbers.
double ProposeDepth(const PairGeometry& geometry, CounterRandom& random) {
  const double linear = geometry.lambda() / 2, quadratic = geometry.delta() / 3;
  double largest = std::max(random.Uniform(), random.Uniform());
  if (random.Uniform() * (linear + quadratic) > linear)
    largest = std::max(largest, random.Uniform());
  return geometry.delta() * largest;
}

}  // namespace

double HalfHeight(const PairGeometry& geometry, double t) {
  return t * (geometry.lambda() + t) / (0.5 + CentreToArc(geometry, t));
}

Eigen::Vector2d UniformOnCollisionSurface(const PairGeometry& geometry, CounterRandom& random) {
  // 1/(1/2 + s) grows with t, so its value at delta bounds it; at least half are accepted.
  const double smallest = 0.5 + CentreToArc(geometry, geometry.delta());
  for (;;) {
    const double t = ProposeDepth(geometry, random);
    if (random.Uniform() * (0.5 + CentreToArc(geometry, t)) > smallest) continue;
    return {geometry.tip() - t, (2 * random.Uniform() - 1) * HalfHeight(geometry, t)};
  }
}

}  // namespace ballpiston
