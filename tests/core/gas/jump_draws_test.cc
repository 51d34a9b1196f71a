#include "core/gas/jump_draws.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// Three bodies with a quarter of all places, and two with the others.
JumpKinds TwoKinds() {
  return {{{.before = 0, .per_place = 12, .first = 0, .count = 3, .largest = 2},
           {.before = 0.25, .per_place = 2 / 0.75, .first = 3, .count = 2, .largest = 5}}};
}

TEST(JumpDraws, BodiesAtTheEdgesOfPlacesAreOfTheirKind) {
  JumpAttempts attempts = {};
  for (size_t i = 0; i < kJumpDraws; ++i) attempts.words[i] = i % 2 == 0 ? 0 : ~uint64_t{0};
  FindJumpAttempts(TwoKinds(), attempts);
  for (size_t i = 0; i < kJumpDraws; ++i) {
    EXPECT_EQ(attempts.bodies[i], i % 2 == 0 ? 0 : 4);
    EXPECT_GE(attempts.least_speeds[i], 0);
  }
}

// A kind at rest has no places.
TEST(JumpDraws, OnlyMovingKindsAreChosen) {
  const JumpKinds kinds = {{{.before = 0, .per_place = 3, .first = 0, .count = 3, .largest = 2},
                            {.before = 1, .per_place = INFINITY, .first = 3, .count = 2}}};
  CounterRandom random(1, 2, 4);
  for (int i = 0; i < 1000; ++i) {
    JumpAttempts attempts;
    DrawJumpAttempts(kinds, random, attempts);
    for (const int32_t body : attempts.bodies) ASSERT_LT(body, 3);
  }
}

}  // namespace
}  // namespace ballpiston
