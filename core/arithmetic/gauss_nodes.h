// Gauss's quadrature as a loop over the nodes.
#pragma once

#include <boost/math/quadrature/gauss.hpp>
#include <cstddef>

namespace ballpiston {

// Calls f(x, weight) at the nodes of (lower, upper). No calls if the interval is empty.
template <int nodes, typename F>
void ForEachGaussNode(double lower, double upper, F f) {
  static_assert(nodes % 2 == 0);  // Boost lists half of them
  using Gauss = boost::math::quadrature::gauss<double, nodes>;
  if (!(upper > lower)) return;
  const double centre = (lower + upper) / 2, half = (upper - lower) / 2;
  for (size_t i = 0; i < Gauss::abscissa().size(); ++i) {
    f(centre - half * Gauss::abscissa()[i], half * Gauss::weights()[i]);
    f(centre + half * Gauss::abscissa()[i], half * Gauss::weights()[i]);
  }
}

// ForEachGaussNode for functions that are smooth in sqrt(upper - x).
template <int nodes, typename F>
void ForEachGaussNodeWithRoot(double lower, double upper, F f) {
  if (!(upper > lower)) return;
  ForEachGaussNode<nodes>(0, 1, [&](double t, double weight) {
    f(upper - (upper - lower) * t * t, 2 * t * (upper - lower) * weight);
  });
}

}  // namespace ballpiston
