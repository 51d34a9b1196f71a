// A function of neighbouring balls and pistons that nearly minimises Varadhan's formula
// (conductivity.h). What it leaves of the current is small, so it makes Green and Kubo's formula
// converge faster (core/gas/jump_current.h).
//
//   f = sum over the balls of sum_r u_r(ball) (w_r(piston on its right) - w_r(piston on its left))
//
// With its bound, the conductivity is exactly
//
//   kappa/kappa_0 - 1 = bound - (integral over t > 0 of <J'(0) J'(t)>)/(kappa_0 T^2 cells)
//
// where J' = L(X + f) is the current that the function leaves. This holds for every f. So the
// coefficients may be rounded, but the bound has to be theirs.
//
// Units: those of galerkin_form.h; temperature 1, neighbouring sites at distance 1. Test:
// TestFunction.HasItsBound.
#ifndef BALLPISTON_CORE_CONDUCTIVITY_TEST_FUNCTION_H_
#define BALLPISTON_CORE_CONDUCTIVITY_TEST_FUNCTION_H_

#include <array>
#include <cstddef>

namespace ballpiston {

struct TestFunction {
  static constexpr size_t kTerms = 2;
  static constexpr size_t kDegree = 5;
  // Of the orthonormal polynomials of degree 1 to kDegree (gamma_law.h).
  using Coefficients = std::array<std::array<double, kDegree>, kTerms>;
  // A value for each term.
  using Values = std::array<double, kTerms>;

  Coefficients of_ball;    // u_r
  Coefficients of_piston;  // w_r
  double bound;            // of kappa/kappa_0 - 1

  Values OfBall(double energy) const;
  Values OfPiston(double energy) const;
};

inline constexpr TestFunction kChainTestFunction = {
    .of_ball = {{{0.01213, 0.001225, -0.003056, 0.002609, -0.00163},
                 {0.002233, -0.007515, 0.004015, -0.001776, 0.0006295}}},
    .of_piston = {{{-0.3082, 0.7387, -0.508, 0.2882, -0.1352},
                   {0.8885, 0.02214, -0.2849, 0.2945, -0.2053}}},
    .bound = -0.0012432438915600014};

inline constexpr TestFunction kLatticeTestFunction = {
    .of_ball = {{{0.008635, -0.001144, -0.0008525, 0.001128, -0.0008079},
                 {-6.301e-05, -0.005437, 0.003458, -0.001842, 0.0008258}}},
    .of_piston = {{{-0.03708, 0.7536, -0.5464, 0.3246, -0.1638},
                   {0.9443, -0.168, -0.1327, 0.1957, -0.1556}}},
    .bound = -0.00088913300460926464};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_CONDUCTIVITY_TEST_FUNCTION_H_
