// The jump process of the pair: the billiard's energy exchange in the limit of rare collisions,
// delta -> 0 (eq. meq with the kernel W of kernel.h), sampled exactly and without rejection.
//
// State: u = sqrt(2 ep) in [0, 1], ep the piston's energy of 1/2 in all; s = sqrt(1 - u^2) =
// sqrt(2 eb). The pair waits for a time that is exponential with the rate r(u) =
// PairCollisionRate(u^2/2), then jumps to u' in [0, s], whose density is proportional to
// max(u, u')/sqrt(s^2 - u'^2). Units: times |G|/|dG_bp|, rates |dG_bp|/|G|.
//
// With A = atan2(u, q), q = sqrt(max(1 - 2 u^2, 0)) and c = q + u A,
//
//   r(u) = c/(sqrt2 pi)
//   F(u') = u asin(u'/s)/c                for u' <= min(u, s): the arcsine law
//   F(u') = 1 - sqrt(s^2 - u'^2)/c        for u < u' <= s: uniform in sqrt(eb - ep')
//
// so F, the distribution function of u', inverts in closed form, and two uniform numbers make a
// jump: -log(the first)/r, and F^-1(the second).
//
// Domain: u in [0, 1], ends included; uniform numbers in (0, 1). Never a NaN, a u outside of
// [0, 1], or a waiting time that is not positive and finite. At u = 1 the ball rests: the next u is
// 0 for certain.
//
// Properties, each with the test that bears its name:
//   1. InvertsTheDistributionOfW: u' is the exact quantile within a relative kJumpError.
//   2. WaitsWithTheRateOfCollisions, within a relative kJumpError.
//   3. DetailedBalance: the stationary law is uniform in u.
//   4. LanesAreTheScalarDefinition, within a relative kJumpError.
//   5. SameBitsOnEveryProcessor with fused multiply-add, and DoesNotDependOnWhoElseWalks.
#ifndef BALLPISTON_CORE_MARKOV_JUMP_PROCESS_H_
#define BALLPISTON_CORE_MARKOV_JUMP_PROCESS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/markov/jump_process_lanes.h"

namespace ballpiston {

inline constexpr double kJumpError = 2e-15;  // 1e-15 measured

struct Jump {
  double waiting_time = 0;  // before it
  double u = 0;             // after it
};

// One jump, by the C library: the definition, to rounding. u' grows with target_uniform.
Jump JumpFrom(double u, double waiting_uniform, double target_uniform);

// Many independent walkers, in step, in vector lanes: 100 million jumps a second on one core.
//
// Walker i is sample first + i of (seed, stream): its jump n (from 0) takes the words at positions
// 4 + 2 n, for the waiting time, and 5 + 2 n, for the target, of the sequence of
// CounterRandom(seed, stream, first + i). The first four are left to whoever draws the start.
//
// Some thousand walkers stay in the processor's nearest cache. Not for sharing between threads.
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
  // By walker; then come walkers nobody sees, up to a whole number of groups.
  std::vector<double> u_;
  std::vector<double> times_;
  std::vector<JumpWords> words_;  // by group, for two jumps
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_MARKOV_JUMP_PROCESS_H_
