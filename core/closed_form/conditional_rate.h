// The rate of ball-piston collisions at a given piston energy.
//
//   phi(ep) = tau_bp nu_bp(ep)               eq. numft, the same for every geometry
//   tau_bp(ep) = 1/nu_bp(ep) = tau_bp/phi    eqs. taubpmftep, cnuep; exact for every delta,
//                                            0 < ep < 1/2
//
// Symbols: ep energy of the piston, total energy 1/2. phi has no dimension, times are in cells over
// unit speed. Domain: ep in [0, 1/2], every PairGeometry.
//
// Properties, each with the test that bears its name:
//   1. AccurateForEveryEnergy: relative error below kConditionalRateRelativeError. Phi increases
//      from sqrt(8)/pi through phi(1/4) = 1 to sqrt(2).
//   2. AveragesToTheUnconditionalRate: int phi dep/sqrt(2 ep) = 1, eq. intcnuep.
//
// Pure functions: safe from any thread.
#pragma once

#include "core/geometry/pair_geometry.h"

namespace ballpiston {

inline constexpr double kConditionalRateRelativeError = 1e-15;

double Phi(double ep);

// The mean time to return to the collision surface at fixed energies. At exactly ep = 0 and
// ep = 1/2 the piston or the ball rests, and only the visited part of phase space counts
// (VolumesAtRest). There the value is the mean along an orbit, and differs from the limit of
// tau_bp/phi.
double ConditionalMeanFreeTime(const PairGeometry& geometry, double ep);

}  // namespace ballpiston
