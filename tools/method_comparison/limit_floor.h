// The limit of rare collisions as a substitute for the billiard: its bias at one delta, and the
// work after which the billiard has the same error.
//
// The methods of the limit, kMarkov and kSpectrum, have the same bias, which more work does not
// reduce: their floor. The spectrum shows it without scatter. A bias below kFloorResolved
// statistical errors of the truth may be chance. Then only an upper bound is known: bias +
// kFloorResolved * error.
//
// The billiard has no bias, and its own error falls as 1/sqrt(work). At the crossing work this
// error equals the floor. For a larger tolerance the limit is as good and costs less. For a smaller
// tolerance the limit cannot be used. If the floor is an upper bound, the crossing work is a lower
// bound.
#pragma once

#include <cstdint>

#include "tools/method_comparison/method_comparison.h"

namespace ballpiston::method_comparison {

inline constexpr double kFloorResolved = 2;

// Slow pistons cause much of the scatter, and they are rare. Therefore the estimated error of a run
// of fewer orbits is too uncertain.
inline constexpr uint64_t kFewestFloorOrbits = 256;

// Returns a measurement of kLimitFloor. `spectrum` is the relaxation time at a delta by kSpectrum,
// `billiard` the longest run of kLanes at the same delta, whose scatter is known best.
MethodMeasurement LimitFloorOf(const MethodMeasurement& spectrum,
                               const MethodMeasurement& billiard);

}  // namespace ballpiston::method_comparison
