// Constants of the markov-property experiment that its tests rely on.
#pragma once

#include <cstdint>

namespace ballpiston {

// Large enough that an orbit's first exchange, which has no exchange before it, costs little; small
// enough that there are enough orbits to fill the lanes.
inline constexpr uint64_t kExchangesPerOrbit = 32;

}  // namespace ballpiston
