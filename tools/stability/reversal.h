// The velocity of an orbit is reversed after some hits, and the orbit returns. Its distance from
// its start is the rounding error of twice this number of hits.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace ballpiston::stability {

inline constexpr std::array<uint64_t, 6> kReversalHits = {1, 2, 5, 10, 20, 30};

struct Reversal {
  std::string method;
  std::array<double, kReversalHits.size()> median;  // distance, in cells; NaN: too few orbits
};

// The ball alone, for any orbits at the paper's radius.
std::vector<Reversal> BallReversals(uint64_t orbits);

// Ball and piston, from one collision back to the previous collision, by the number of wall hits
// between them. At the paper's radius and delta = 0.1.
std::vector<Reversal> PairReversals(uint64_t orbits);

}  // namespace ballpiston::stability
