// The velocity of an orbit is reversed after some hits, and the orbit returns. Its distance from
// its start is the rounding error of twice this number of hits.
#pragma once

#include <cstdint>
#include <string>

namespace ballpiston::stability {

// The medians of the distances, in cells, by method and number of hits. At the paper's radius and
// delta = 0.1:
//   - the ball alone, for any `orbits` orbits;
//   - ball and piston, from one collision back to the previous collision, by the number of wall
//     hits between them, for 20 times as many orbits.
std::string ReversalTable(uint64_t orbits);

}  // namespace ballpiston::stability
