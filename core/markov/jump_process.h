// The jump process of the pair: the billiard's energy exchange in the limit of rare collisions,
// delta -> 0 (eq. meq with the kernel W of kernel.h), sampled exactly and without rejection.
//
// State: u = sqrt(2 ep) in [0, 1], where ep is the piston's energy and the total energy is 1/2;
// s = sqrt(1 - u^2) = sqrt(2 eb). The pair waits for an exponential time with the rate r(u) =
// PairCollisionRate(u^2/2), then jumps to u' in [0, s] with a density proportional to
// max(u, u')/sqrt(s^2 - u'^2). Units: times |G|/|dG_bp|, rates |dG_bp|/|G|.
//
// With A = atan2(u, q), q = sqrt(max(1 - 2 u^2, 0)) and c = q + u A,
//
//   r(u) = c/(sqrt2 pi)
//   F(u') = u asin(u'/s)/c                for u' <= min(u, s): the arcsine law
//   F(u') = 1 - sqrt(s^2 - u'^2)/c        for u < u' <= s: uniform in sqrt(eb - ep')
//
// So F, the distribution function of u', has an inverse in closed form. Two uniform numbers give a
// jump: the waiting time is -log(the first)/r, and u' is F^-1(the second).
//
// Domain: u in [0, 1], ends included; uniform numbers in (0, 1). Results are always numbers: u' in
// [0, 1], and a positive and finite waiting time. At u = 1 the ball rests, and the next u is always
// 0.
//
// Properties, each with the test that bears its name:
//   1. InvertsTheDistributionOfW: u' is the exact quantile within a relative kJumpError.
//   2. WaitsWithTheRateOfCollisions, within a relative kJumpError.
// Walkers are independent of each other. The stationary law is uniform in u. The bits are the same
// on every processor with fused multiply-add (tests/core/billiard/golden_test.cc).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ballpiston {

inline constexpr double kJumpError = 2e-15;  // 1e-15 measured

// The size of a group of walkers: a whole number of vectors on every processor.
inline constexpr size_t kJumpGroup = 32;

// Words 4 block, ..., 4 block + 3 of the sequences of CounterRandom for samples first, first + 1,
// ...: by word, then by sample.
struct JumpWords {
  uint64_t words[4][kJumpGroup];
};

// Replaces the u of a group by the u after a jump, and writes the waiting times. The uniform
// numbers are those that CounterRandom computes from the words.
void JumpInLanes(const uint64_t* waiting_words, const uint64_t* target_words, double* u,
                 double* waiting_times);

// Many independent walkers, in step, in vector lanes: 100 million jumps a second on one core.
//
// Walker i is sample first + i of (seed, stream): its jump n (from 0) takes the words at positions
// 4 + 2 n, for the waiting time, and 5 + 2 n, for the target, of the sequence of
// CounterRandom(seed, stream, first + i). The first four words are reserved for the walker's start.
//
// About a thousand walkers fit into the first-level cache. Not thread-safe.
class JumpWalkers {
 public:
  // Walkers start at u.
  JumpWalkers(uint64_t seed, uint64_t stream, uint64_t first, std::vector<double> u);

  // Each walker waits and jumps once.
  void Jump();

  // After the last jump.
  std::span<const double> u() const { return std::span(u_).first(walkers_); }
  // Before the last jump; 0 before the first one.
  std::span<const double> waiting_times() const { return std::span(times_).first(walkers_); }

 private:
  uint64_t seed_;
  uint64_t stream_;
  uint64_t first_;
  size_t walkers_;
  uint64_t jumps_ = 0;
  // By walker; padded with unused walkers to a whole number of groups.
  std::vector<double> u_;
  std::vector<double> times_;
  std::vector<JumpWords> words_;  // by group, for two jumps
};

}  // namespace ballpiston
