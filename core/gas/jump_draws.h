// The random numbers of a gas's jump process, drawn in advance, many at once in vector lanes. An
// attempt chooses a body, and the least speed at which the body proposes an exchange. A proposal
// has an angle of the ball, and a time since the last proposal. The bits are the same on every
// target with fused multiply-add.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/sampling/counter_random.h"

namespace ballpiston {

inline constexpr size_t kJumpDraws = 32;  // a whole number of vectors on every processor

// Bodies `first` to `first + count - 1`, at most 2^31 - 1. All have the same rate of attempts. A
// uniform number, the place, chooses the body.
struct JumpBodies {
  double before = 0;     // where the places of these bodies begin, in [0, 1]
  double per_place = 0;  // bodies per unit of place
  double first = 0;
  double count = 0;
  double largest = 0;  // least speeds are uniform below it
};
using JumpKinds = std::array<JumpBodies, 2>;  // the places of the second follow those of the first

struct JumpAttempts {
  uint64_t words[kJumpDraws];  // the lowest 12 bits are not used here
  int32_t bodies[kJumpDraws];
  double least_speeds[kJumpDraws];
};

void DrawJumpAttempts(const JumpKinds& kinds, CounterRandom& random, JumpAttempts& attempts);
// Computes the attempts again from the same words, after the kinds have changed.
void FindJumpAttempts(const JumpKinds& kinds, JumpAttempts& attempts);

// Cosines of the angle between a ball's direction and that to the piston: [0] for a proposal of the
// ball, whose angles have a weight in proportion to a positive cosine; [1] for one of the piston,
// whose angles are uniform. A proposal uses one of them. The waiting times have mean 1.
struct JumpProposals {
  double cosines[2][kJumpDraws];
  double waits[kJumpDraws];
};
void DrawJumpProposals(CounterRandom& random, JumpProposals& proposals);

}  // namespace ballpiston
