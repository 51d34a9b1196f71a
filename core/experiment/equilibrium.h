// Constants of the equilibrium experiment that its tests rely on.
#ifndef BALLPISTON_CORE_EXPERIMENT_EQUILIBRIUM_H_
#define BALLPISTON_CORE_EXPERIMENT_EQUILIBRIUM_H_

#include <cstdint>

namespace ballpiston {

// One collision in ten counts as an event for the error (statistics/told_error.h), because long
// flights are rare and skew the law of the ratio: the z-scores of 100 seeds with 64 collisions had
// variance 1.35.
inline constexpr double kEventsPerCollision = 0.1;

// Orbits in a block, if it has as many collisions: batches enough for an error, and lanes kept
// full.
inline constexpr uint64_t kOrbitsPerBlock = 256;

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_EQUILIBRIUM_H_
