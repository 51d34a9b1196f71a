// Mean free times of the pair at total energy 1/2, exact for every delta: in equilibrium,
//
//   tau_x = 4 |G|/|dG_x|,  x = bp, bw, pw                       eqs. taubpmft, tauwall
//
// and from a return to the next at a given energy ep of the piston, 0 < ep < 1/2,
//
//   phi(ep) = tau_bp nu_bp(ep)                 eq. numft, the same for every geometry
//   tau_bp(ep) = 1/nu_bp(ep) = tau_bp/phi      eqs. taubpmftep, cnuep
//
// and the limit of rare interactions:
//
//   lim delta -> 0 of 1/(tau_bp delta^2) = 1/(2 sqrt(2) cell)    eq. taubpmftdelta
//
// Units: cells over unit speed; phi has no dimension. Domain: every PairGeometry with delta >
// 1e-140 (pair_measures.h), ep in [0, 1/2].
//
// Properties, each with the test that bears its name:
//   1. AccurateForEveryGeometry: relative error below kMeanFreeTimeRelativeError.
//   2. RareLimitRateIsTheLimitOfTheRate 1/(tau_bp delta^2).
//   3. PhiIsAccurateForEveryEnergy: relative error below kConditionalRateRelativeError. Phi
//      increases from sqrt(8)/pi through phi(1/4) = 1 to sqrt(2).
// The average of phi, int phi dep/sqrt(2 ep), is 1 (eq. intcnuep). The limits delta -> 0 and
// rho -> 1/2 of delta^2 |G|/|dG_bp| are (4 - pi)/(4 sqrt(2)) in this order and three times as large
// in the other (eq. limitsrhodelta). The ratio delta/lambda decides: the piston moves in a wedge if
// delta << lambda, in a cusp if delta >> lambda.
//
// Pure functions: safe from any thread.
#pragma once

#include "core/closed_form/pair_measures.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

inline constexpr double kMeanFreeTimeRelativeError = 5e-15;
inline constexpr double kConditionalRateRelativeError = 1e-15;

struct MeanFreeTimes {
  double ball_piston;
  double ball_wall;
  double piston_wall;
};

MeanFreeTimes MeanFreeTimesFrom(const PairMeasures& measures);
MeanFreeTimes MeanFreeTimesOf(const PairGeometry& geometry);

double Phi(double ep);

// The mean time to return to the collision surface at fixed energies. At exactly ep = 0 and
// ep = 1/2 the piston or the ball rests, and only the visited part of phase space counts
// (VolumesAtRest). There the value is the mean along an orbit, and differs from the limit of
// tau_bp/phi.
double ConditionalMeanFreeTime(const PairGeometry& geometry, double ep);

// lim delta -> 0 of 1/(tau_bp delta^2). Domain: kMinRho < rho < kMaxRho.
double RareLimitRate(double rho);

}  // namespace ballpiston
