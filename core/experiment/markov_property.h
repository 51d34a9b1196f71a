// Constants of the markov-property experiment that its tests rely on.
#ifndef BALLPISTON_CORE_EXPERIMENT_MARKOV_PROPERTY_H_
#define BALLPISTON_CORE_EXPERIMENT_MARKOV_PROPERTY_H_

#include <cstdint>

namespace ballpiston {

// Large enough that an orbit's first exchange, which has no exchange before it, costs little; small
// enough that there are enough orbits to fill the lanes.
inline constexpr uint64_t kExchangesPerOrbit = 32;

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_MARKOV_PROPERTY_H_
