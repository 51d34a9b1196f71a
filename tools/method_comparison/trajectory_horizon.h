// The number of wall hits for which the orbits of a method stay close to their twins.
//
// After each hit of the method's ball, the ball's position is compared with the twin's position at
// the same time. (A fixed step detects a hit up to one step late; therefore hits of the same number
// cannot be compared.) A method starts from its own rounding of the twin's start. The error eps of
// one hit grows by a factor exp(L) per hit, where L is the Lyapunov exponent. Therefore the horizon
// is about log(kParted/eps)/L. Property, with a test of its name:
// 1. HorizonGrowsWithTheLogarithmOfThePrecision.
#pragma once

#include <cstdint>

#include "core/geometry/pair_geometry.h"
#include "core/statistics/moments.h"
#include "tools/method_comparison/method.h"
#include "tools/method_comparison/twin_orbits.h"

namespace ballpiston::method_comparison {

// The largest number of hits of an orbit. All orbits of 113 bits part earlier, while the twin is
// still correct. If the cell is hardly larger than kParted (rho near 1/sqrt(2)), some orbits do not
// part; then this number counts as their horizon.
inline constexpr uint64_t kMostHits = 128;

struct TrajectoryHorizon {
  Moments hits;            // per orbit, until the orbit and its twin are kParted apart
  uint64_t wall_hits = 0;  // computed in `seconds`, also those after the parting
  double seconds = 0;      // of processor time, without the time of the twins
};

// The horizon of all orbits of `twins`. Not for kClosedForm, kMarkov, kSpectrum.
TrajectoryHorizon HorizonOf(const MethodVariant& variant, const PairGeometry& geometry,
                            TwinOrbits& twins);

}  // namespace ballpiston::method_comparison
