// Constants of the markov-property experiment that its tests rely on.
#ifndef BALLPISTON_CORE_EXPERIMENT_MARKOV_PROPERTY_H_
#define BALLPISTON_CORE_EXPERIMENT_MARKOV_PROPERTY_H_

#include <cstdint>

namespace ballpiston {

// Enough that the one exchange of an orbit that has no other before it costs little, and few enough
// that orbits fill the lanes.
inline constexpr uint64_t kExchangesPerOrbit = 32;

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_MARKOV_PROPERTY_H_
