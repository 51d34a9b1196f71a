// The lifetime of an orbit whose hit times assume |v| = 1 while its reflections do not.
#pragma once

#include <cstdint>
#include <vector>

namespace ballpiston::stability {

// The number of wall hits before the escape, for `orbits` orbits at the paper's radius, in
// ascending order.
std::vector<uint64_t> HitsBeforeEscape(uint64_t orbits);

}  // namespace ballpiston::stability
