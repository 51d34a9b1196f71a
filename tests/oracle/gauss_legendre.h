// Gauss-Legendre quadrature with 32 nodes in quadruple precision: exact to rounding for integrands
// that are analytic well beyond the interval. Integrands with a kink are to be cut there.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "tools/flows/quad_precision.h"

namespace ballpiston::oracle {

struct GaussNode {
  Quad x;
  Quad weight;
};

inline constexpr int kGaussNodes = 32;

// Newton's iteration on the Legendre polynomial from the usual estimate of its i-th zero.
inline GaussNode MakeGaussNode(int i) {
  Quad x = std::cos(std::numbers::pi * (i + 0.75) / (kGaussNodes + 0.5));
  Quad slope = 0;
  for (int step = 0; step < 6; ++step) {
    Quad p = 1;
    Quad previous = 0;
    for (int k = 1; k <= kGaussNodes; ++k) {
      const Quad next = ((2 * k - 1) * x * p - (k - 1) * previous) / k;
      previous = p;
      p = next;
    }
    slope = kGaussNodes * (x * p - previous) / (x * x - 1);
    x -= p / slope;
  }
  return {x, 2 / ((1 - x * x) * slope * slope)};
}

inline const std::array<GaussNode, kGaussNodes>& GaussNodes() {
  static const auto nodes = [] {
    std::array<GaussNode, kGaussNodes> made;
    for (int i = 0; i < kGaussNodes; ++i) made[static_cast<size_t>(i)] = MakeGaussNode(i);
    return made;
  }();
  return nodes;
}

// Integral of integrand from a to b; the integrand takes a Quad.
template <typename Integrand>
Quad Integrate(Integrand integrand, Quad a, Quad b) {
  Quad sum = 0;
  for (const GaussNode& node : GaussNodes()) {
    sum += node.weight * Quad{integrand((a + b) / 2 + (b - a) / 2 * node.x)};
  }
  return sum * (b - a) / 2;
}

// The integral from a to b of a function with powers of sqrt(b - x), which is smooth in v with
// x = b - v^2.
template <typename Integrand>
Quad IntegrateToRoot(Integrand integrand, Quad a, Quad b) {
  return Integrate([&](Quad v) { return 2 * v * integrand(b - v * v); }, 0, sqrt(b - a));
}

}  // namespace ballpiston::oracle
