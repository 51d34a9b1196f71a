// A function of neighbouring balls and pistons that nearly minimises Varadhan's formula
// (conductivity.h). The remaining current J' is small, so Green and Kubo's formula converges faster
// (core/gas/jump_current.h).
//
//   f = sum over the balls of sum_r u_r(ball) (w_r(piston on its right) - w_r(piston on its left))
//
// With its bound, the conductivity is exactly
//
//   kappa/kappa_0 - 1 = bound - (integral over t > 0 of <J'(0) J'(t)>)/(kappa_0 T^2 cells)
//
// where J' = L(X + f) is the remaining current. This holds for every f. So the coefficients may be
// rounded, but the bound must be computed from the rounded coefficients.
//
// u_r and w_r are sums of exp(-e/2), exp(-e) and exp(-2 e). In the chain the best function of
// neighbouring balls and pistons has the bound -0.001331; this function has -0.001311. Polynomials
// do not work: their large values at rare energies would dominate the scatter.
//
// Units: those of galerkin_form.h; temperature 1, neighbouring sites at distance 1. Test:
// TestFunction.HasItsBound.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "core/arithmetic/elementary_functions.h"

namespace ballpiston {

struct TestFunction {
  static constexpr int kTerms = 2;
  using Values = Eigen::Array<double, kTerms, 1>;  // one for each term
  // The coefficients of the three exponentials, for each term.
  using Coefficients = std::array<std::array<double, 3>, kTerms>;

  Coefficients of_ball;    // u_r
  Coefficients of_piston;  // w_r
  double bound;            // of kappa/kappa_0 - 1, to 1e-10

  Values OfBall(double energy) const { return Sums(of_ball, energy); }
  Values OfPiston(double energy) const { return Sums(of_piston, energy); }

 private:
  static Values Sums(const Coefficients& coefficients, double energy) {
    const double slow = Exp(-energy / 2), middle = slow * slow, fast = middle * middle;
    Values sums;
    for (int r = 0; r < kTerms; ++r) {
      const auto& c = coefficients[static_cast<size_t>(r)];
      sums[r] = c[0] * slow + c[1] * middle + c[2] * fast;
    }
    return sums;
  }
};

inline constexpr TestFunction kChainTestFunction = {
    .of_ball = {{{-2.283, 0.2532, 0.8803}, {-6.652, 7.568, -1.696}}},
    .of_piston = {{{-1, 0.6998, 0.1074}, {-0.3936, 1, -0.5217}}},
    .bound = -0.00131092042};

inline constexpr TestFunction kLatticeTestFunction = {
    .of_ball = {{{-0.8150, -0.9260, 0.9235}, {-4.109, 4.208, -0.6564}}},
    .of_piston = {{{-1, 0.6956, 0.06957}, {-0.4267, 1, -0.4763}}},
    .bound = -0.00092723546};

}  // namespace ballpiston
