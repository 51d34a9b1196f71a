// What the jump process of a gas draws ahead, many at once in vector lanes: attempts, each of which
// chooses a body and a least speed, and waiting times. The bits are the same wherever multiply-add
// is fused.
#ifndef BALLPISTON_CORE_GAS_JUMP_DRAWS_H_
#define BALLPISTON_CORE_GAS_JUMP_DRAWS_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/sampling/counter_random.h"

namespace ballpiston {

inline constexpr size_t kJumpDraws = 32;  // a whole number of vectors on every processor

// Bodies `first` to `first + count - 1`, at most 2^31 - 1. As many attempts fall on each of them.
struct JumpBodies {
  double before = 0;     // place in [0, 1] of the first one's attempts
  double per_place = 0;  // bodies
  double first = 0;
  double count = 0;
  double largest = 0;  // least speeds are uniform below it
};
using JumpKinds = std::array<JumpBodies, 2>;  // the places of the second follow those of the first

struct JumpAttempts {
  uint64_t words[kJumpDraws];  // their lowest 12 bits decide nothing here
  int32_t bodies[kJumpDraws];
  double least_speeds[kJumpDraws];
};

void DrawJumpAttempts(const JumpKinds& kinds, CounterRandom& random, JumpAttempts& attempts);
// By the same words, after the kinds have changed.
void FindJumpAttempts(const JumpKinds& kinds, JumpAttempts& attempts);

// Exponential, of mean 1.
using JumpWaits = std::array<double, kJumpDraws>;
void DrawJumpWaits(CounterRandom& random, JumpWaits& waits);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_GAS_JUMP_DRAWS_H_
