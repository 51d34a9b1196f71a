// Gauss-Legendre quadrature with 30 nodes in quadruple precision (Boost's): exact to rounding for
// integrands that are analytic well beyond the interval. Cut an integrand with a kink at the kink.
#pragma once

#include <boost/math/quadrature/gauss.hpp>

#include "tools/flows/quad_precision.h"

namespace ballpiston::oracle {

inline constexpr int kGaussNodes = 30;

// Calls add(x, weight) for each node from a to b.
template <typename Add>
void ForEachGaussNode(Quad a, Quad b, Add add) {
  using Rule = boost::math::quadrature::gauss<Quad, kGaussNodes>;  // the nodes above 0
  const Quad middle = (a + b) / 2, half_width = (b - a) / 2;
  for (size_t i = 0; i < kGaussNodes / 2; ++i) {
    const Quad away = half_width * Rule::abscissa()[i], weight = half_width * Rule::weights()[i];
    add(middle - away, weight);
    add(middle + away, weight);
  }
}

// Integral of integrand from a to b; the integrand takes a Quad.
template <typename Integrand>
Quad Integrate(Integrand integrand, Quad a, Quad b) {
  Quad sum = 0;
  ForEachGaussNode(a, b, [&](Quad x, Quad weight) { sum += weight * Quad{integrand(x)}; });
  return sum;
}

// The integral from a to b of a function with powers of sqrt(b - x), which is smooth in v with
// x = b - v^2.
template <typename Integrand>
Quad IntegrateToRoot(Integrand integrand, Quad a, Quad b) {
  return Integrate([&](Quad v) { return 2 * v * integrand(b - v * v); }, 0, sqrt(b - a));
}

}  // namespace ballpiston::oracle
