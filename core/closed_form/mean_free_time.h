// Mean free times of the pair in equilibrium at total energy 1/2, exact for every delta.
//
//   tau_x = 4 |G|/|dG_x|,  x = bp, bw, pw                       eqs. taubpmft, tauwall
//
// and their limit of rare interactions:
//
//   lim delta -> 0 of 1/(tau_bp delta^2) = 1/(2 sqrt(2) cell)    eq. taubpmftdelta
//
// Units: cells over unit speed. Domain: every PairGeometry with delta > 1e-140 (pair_measures.h).
//
// Properties, each with the test that bears its name:
//   1. AccurateForEveryGeometry: relative error below kMeanFreeTimeRelativeError.
//   2. RareLimitRateIsTheLimitOfTheRate 1/(tau_bp delta^2).
//   3. DeltaFirstThenRhoGivesTheWedge, RhoFirstThenDeltaGivesTheCusp: the limits delta -> 0 and
//      rho -> 1/2 of delta^2 |G|/|dG_bp| differ by a factor of three (eq. limitsrhodelta). The
//      ratio delta/lambda decides: the piston moves in a wedge if delta << lambda, in a cusp if
//      delta >> lambda.
//
// Pure functions: safe from any thread.
#pragma once

#include <numbers>

#include "core/closed_form/pair_measures.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

inline constexpr double kMeanFreeTimeRelativeError = 5e-15;

struct MeanFreeTimes {
  double ball_piston;
  double ball_wall;
  double piston_wall;
};

MeanFreeTimes MeanFreeTimesFrom(const PairMeasures& measures);
MeanFreeTimes MeanFreeTimesOf(const PairGeometry& geometry);

// lim delta -> 0 of 1/(tau_bp delta^2). Domain: kMinRho < rho < kMaxRho.
double RareLimitRate(double rho);

// delta^2 |G|/|dG_bp|. Its double limit depends on the order of the limits.
double ScaledVolumeRatio(const PairGeometry& geometry);

// lim rho -> 1/2 of lim delta -> 0 of ScaledVolumeRatio: (4 - pi)/(4 sqrt 2).
inline constexpr double kDeltaFirstScaledVolumeRatio =
    (4 - std::numbers::pi) / (4 * std::numbers::sqrt2);

// lim delta -> 0 of lim rho -> 1/2 of ScaledVolumeRatio: 3 (4 - pi)/(4 sqrt 2).
inline constexpr double kRhoFirstScaledVolumeRatio = 3 * kDeltaFirstScaledVolumeRatio;

}  // namespace ballpiston
