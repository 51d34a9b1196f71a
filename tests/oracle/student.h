// Student's t.
#pragma once

#include <cmath>
#include <numbers>

namespace ballpiston {

// The probability of |t| <= x with this many degrees of freedom: the integral of the density, by
// Simpson's rule.
inline double StudentProbability(double freedom, double x) {
  constexpr int kSteps = 400;
  const double log_of_factor = std::lgamma((freedom + 1) / 2) - std::lgamma(freedom / 2) -
                               std::log(freedom * std::numbers::pi) / 2;
  const double step = x / kSteps;
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double t = i * step;
    const double weight = i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2;
    sum += weight * std::exp(log_of_factor - (freedom + 1) / 2 * std::log1p(t * t / freedom));
  }
  return 2 * sum * step / 3;
}

// The x with StudentProbability(freedom, x) = probability < 0.999, freedom >= 1; by bisection.
inline double StudentQuantile(double freedom, double probability) {
  double below = 0, above = 700;
  while (above - below > 1e-6) {
    const double middle = (below + above) / 2;
    (StudentProbability(freedom, middle) < probability ? below : above) = middle;
  }
  return below;
}

}  // namespace ballpiston
