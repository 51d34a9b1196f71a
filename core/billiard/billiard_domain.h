// The rho, delta and epsilon at which a billiard engine is sound. Elsewhere the billiard models are
// refused; closed forms and the limit delta -> 0 have no such bounds.
//
// ---- double precision ----
//
// A ball's position is rounded to about 1e-16. So its error in a tip is of order 1e-16/delta. At a
// grazing hit, where the ball leaves a disc at the angle s to its tangent, the error along the path
// is 1e-16/s. In a cell of the size g = 1/sqrt 2 - rho a share of order (1e-16/g)^2 of all hits
// therefore ends anywhere in the cell, or outside of it.
//
// Measured: conditional mean free times with balls so slow (epsilon = 1/2 - 1e-16) that they cross
// the cell as often as the piston comes, relative to the closed form, and lost orbits.
//
//   g       delta/bound   lanes: difference    lost     hits, about  reference
//   1e-8    1             -0.8(6)e-3           0        4e6          -0.8(6)e-3
//   1e-9    1              0.3(3)e-3           0        3e8          -0.5(10)e-3
//   1e-9    0.1           -2(3)e-3             0        5e7           2(2)e-2
//   1e-10   1              0.0(8)e-3           0        4e8           5(3)e-3
//   1e-11   1             -2(2)e-3             0        6e8           1(9)e-3
//   1e-11   0.3            2(8)e-3             0        3e9           -
//   1e-12   0.3            5(20)e-3            1        3e9           -
//   1e-12   1              2(5)e-3             2        7e8           3(30)e-3
//   1e-13   1             -10(10)e-3           3        6e8          -3(9)e-2
//   1e-15   1              6 of 7 lost, no end in 3 s                 no end in 3 s
//
// Runs that were cut short (delta/bound < 1, and g below 1e-10) favour short returns. The largest
// |2 E - 1| was 1e-15 everywhere. By the
// share above, which the two rows of g = 1e-12 fit, a ball is lost about once in 1e14 wall hits at
// g = 1e-9: extrapolated, not measured. At epsilon = 0 and g = 1e-8 and 1e-9 mean free times agree
// with the closed form within 0.4 % to 1 %, one standard error each. Smaller deltas in wide cells
// are too expensive to measure; there the bound rests on the rounding of positions.
//
// In the lanes of a gas, chains of 3 at the largest delta, of 3e8 wall hits at each g 6 lost a ball
// at g = 1e-14, 1 at 3e-14, and none at 1e-13, 3e-13, 1e-12, 1e-11, 1e-10; the reference lost none
// in 1e7 at 1e-13 to 1e-9. So a gas loses fewer balls than a pair, and the pair's bound holds for
// both. Nearer to 1/sqrt 2 no exchange of a gas was measured: at g = 1e-9 it takes 6e9 wall hits.
//
// At the other end, rho -> 1/2, there is no bound: at rho = 1/2 + 1.1e-16, 1e-14 and 1e-12 mean
// free times in equilibrium (2e-3) and at epsilon = 0.05 and 0.45 (1e-3) agree with the closed
// forms, and no orbit was lost.
//
// ---- single precision ----
//
// The domain in which the lanes may fly in single precision, and the errors of the measured values.
// Flights are in single precision; collisions with the piston are computed in double. So the error
// is that of the density of balls in the tip that the piston reaches. The error grows when the
// tip's depth delta approaches the rounding of a position, and in small cells, where the ball's
// velocity stays correlated for long. Relative differences from exact values, with one standard
// error:
//
//   mean free times at fixed energies, at delta's bound     rho = 0.6            0.9e-4 +- 1.3e-4
//     (6e6 returns at each of 4 energies)                   rho = 0.65          -3.3e-4 +- 1.3e-4
//                                                           rho = 0.7           -1.4e-4 +- 1.3e-4
//                                                           rho = 1/sqrt 2-1e-3 -2.5e-4 +- 1.3e-4
//     at a tenth of it                                      rho = 0.6            0.4e-4 +- 3.2e-4
//                                                           rho = 0.65          -3.5e-4 +- 6.4e-4
//                                                           rho = 0.7            4.1e-4 +- 3.1e-4
//   share of wall hits within 1e-3 of a tip (7e8 hits)      rho = 0.7            2.6e-4 +- 0.9e-4
//     within 1e-4                                                                0.6e-4 +- 2.7e-4
//     within 1e-5                                                                1.6e-3 +- 9e-4
//     within 4e-4 (5e8 hits)                                rho = 1/sqrt 2-1e-3 -3.4e-4 +- 0.6e-4
//     within 1.4e-4                                                             -3.4e-4 +- 1.0e-4
//     within 1.4e-5                                                              3.1e-3 +- 3e-4
//
// The standard errors of the shares assume independent hits, although hits of one ball are
// correlated; in the first four rows of the shares double precision differs as much.
//
// Less precise runs show no difference: mean free times at rho = 0.7, delta = 1e-3 (2.6e-3 +-
// 1.4e-3); the narrow tips of rho = 0.501 and 0.53 (5e-4 +- 3e-4 at delta's bound,
// 1e-3 +- 1e-3 at a tenth of it, 7e-3 at a hundredth); means of cos alpha and sigma (0.03 to 0.4 %
// at the bound); relaxation times compared with double precision (0.3 to 2 %); the Lyapunov
// exponents at rho = 0.53, delta = 0.2 compared with double precision (lambda_1 -1.2e-4 +- 1.6e-4,
// lambda_2 -2.9e-4 +- 4.8e-4), and at the ends of rho (0.1 to 1 %).
//
// At rho - 1/2 from 6e-8 to 6e-7, where the gap between two discs is a few roundings wide, one
// first hit in 1e5 (delta = 0.02) loses its ball or traps it in a tip; at 1e-6 and 1e-5 none did.
//
// A piston's phase is rounded to 6e-8 at each burst of flights. A slower piston moves by no more in
// a burst, so that all its steps are rounded alike. At rho = 0.53 and delta = 0.2 its return times
// deviate by 0.07 % at epsilon = 2e-14, 2.4 % at 5e-15 and 30 % at 4.5e-16; at 2e-16 it rests. So
// the least epsilon is 1e-12, far above that; a piston at rest is exact.
//
// At 1/sqrt 2 - rho = 1e-4 and delta = 1.4e-5 a run of a few seconds did not end within four
// minutes; at 1e-5 orbits leave the cell.
#pragma once

#include "core/geometry/pair_geometry.h"

namespace ballpiston {

struct BilliardDomain {
  double min_rho;
  double max_rho;
  double min_delta;
  double min_epsilon;  // of a piston that moves

  constexpr bool HasRho(double rho) const { return rho >= min_rho && rho <= max_rho; }
  constexpr bool HasDelta(double delta) const { return delta >= min_delta; }
  constexpr bool HasEpsilon(double epsilon) const { return epsilon == 0 || epsilon >= min_epsilon; }
};

// In double precision; every valid rho is above kMinRho.
inline constexpr BilliardDomain kDoubleDomain = {
    .min_rho = kMinRho, .max_rho = kMaxRho - 1e-9, .min_delta = 1e-10, .min_epsilon = 0};

inline constexpr BilliardDomain kSingleDomain = {
    .min_rho = kMinRho + 1e-5, .max_rho = kMaxRho - 1e-3, .min_delta = 1e-3, .min_epsilon = 1e-12};

// Upper bound of the relative error of times in these ranges. No row of the table of single
// precision that lies inside is beyond it by two standard errors, and none of
// tests/data/model_errors.csv. Deeper in the tips it rests on the scaling: positions are rounded by
// 6e-8, below 1e-4 of the least delta.
inline constexpr double kSinglePrecisionError = 5e-4;

}  // namespace ballpiston
