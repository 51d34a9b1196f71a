// For how many wall hits the orbits of a method are those of their twins.
//
// After each hit of the method's ball its place is compared with the twin's at that instant (not at
// the hit of the same number, which a fixed step sees late by up to a step). A method starts from
// its own rounding of the twin's start. The error eps of one hit grows by the Lyapunov exponent L a
// hit, so the horizon is about log(kParted/eps)/L. Property, with a test of its name:
// 1. HorizonGrowsWithTheLogarithmOfThePrecision.
#ifndef BALLPISTON_CORE_METHOD_COMPARISON_TRAJECTORY_HORIZON_H_
#define BALLPISTON_CORE_METHOD_COMPARISON_TRAJECTORY_HORIZON_H_

#include <cstdint>
#include <stop_token>

#include "core/geometry/pair_geometry.h"
#include "core/method_comparison/method.h"
#include "core/method_comparison/twin_orbits.h"
#include "core/statistics/moments.h"

namespace ballpiston {

// No orbit is followed further: of 113 bits all have parted before, where the twin itself still is
// right. Only where the cell is hardly larger than kParted (rho near 1/sqrt(2)) some do not part;
// this then counts as their horizon.
inline constexpr uint64_t kMostHits = 128;

struct TrajectoryHorizon {
  Moments hits;            // until an orbit and its twin are kParted apart, by orbit
  uint64_t wall_hits = 0;  // flown in `seconds`, on beyond the parting
  double seconds = 0;      // of processor time, without the twins'
};

// Of all orbits of `twins`. Not for kClosedForm, kMarkov, kSpectrum. Ends early, and means nothing,
// if `stop` comes.
TrajectoryHorizon HorizonOf(const MethodVariant& variant, const PairGeometry& geometry,
                            TwinOrbits& twins, const std::stop_token& stop);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_METHOD_COMPARISON_TRAJECTORY_HORIZON_H_
