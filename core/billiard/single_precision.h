// The domain in which the lanes may fly in single precision, and the errors of the measured values.
//
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
// 1.4e-3); the narrow tips of rho = 1/2 + 1e-9, 0.501 and 0.53 (5e-4 +- 3e-4 at delta's bound,
// 1e-3 +- 1e-3 at a tenth of it, 7e-3 at a hundredth); means of cos alpha and sigma (0.03 to 0.4 %
// at the bound); relaxation times compared with double precision (0.3 to 2 %); the Lyapunov
// exponents at rho = 0.53, delta = 0.2 compared with double precision (lambda_1 -1.2e-4 +- 1.6e-4,
// lambda_2 -2.9e-4 +- 4.8e-4), and at the ends of rho (0.1 to 1 %).
//
// At 1/sqrt 2 - rho = 1e-4 and delta = 1.4e-5 a run of a few seconds did not end within four
// minutes; at 1e-5 orbits leave the cell.
#pragma once

#include "core/billiard/billiard_domain.h"

namespace ballpiston {

inline constexpr BilliardDomain kSingleDomain = {
    .min_rho = kMinRho + 1e-9, .max_rho = kMaxRho - 1e-3, .min_delta = 1e-3};

// Upper bound of the relative error of times in these ranges. No row of the table above that lies
// inside is beyond it by two standard errors, and none of tests/data/model_errors.csv. Deeper in
// the tips it rests on the scaling: positions are rounded by 6e-8, below 1e-4 of the least delta.
inline constexpr double kSinglePrecisionError = 5e-4;

}  // namespace ballpiston
