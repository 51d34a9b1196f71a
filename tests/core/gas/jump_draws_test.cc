#include "core/gas/jump_draws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "tests/core/billiard/each_target.h"
#include "tests/oracle/one_sample.h"

namespace ballpiston {
namespace {

// Three bodies with a quarter of all places, and two with the others.
JumpKinds TwoKinds() {
  return {{{.before = 0, .per_place = 12, .first = 0, .count = 3, .largest = 2},
           {.before = 0.25, .per_place = 2 / 0.75, .first = 3, .count = 2, .largest = 5}}};
}

TEST(JumpDraws, BodiesOfAKindHaveEqualRatesOfAttempts) {
  const JumpKinds kinds = TwoKinds();
  CounterRandom random(1, 2, 3);
  std::vector<uint64_t> counts(5);
  std::vector<double> speeds;
  for (int i = 0; i < 2000; ++i) {
    JumpAttempts attempts;
    DrawJumpAttempts(kinds, random, attempts);
    for (size_t j = 0; j < kJumpDraws; ++j) {
      const auto body = static_cast<size_t>(attempts.bodies[j]);
      ASSERT_LT(body, counts.size());
      ++counts[body];
      speeds.push_back(attempts.least_speeds[j] / kinds[body < 3 ? 0 : 1].largest);
    }
  }
  // False alarms: 3e-5 and 5e-5.
  const std::vector<double> shares = {1.0 / 12, 1.0 / 12, 1.0 / 12, 3.0 / 8, 3.0 / 8};
  EXPECT_LT(oracle::ChiSquareScoreOf(counts, shares), 4);
  EXPECT_LT(oracle::KolmogorovSmirnov(speeds, [](double x) { return x; }), 2.3);
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

TEST(JumpDraws, WaitsAreExponential) {
  CounterRandom random(1, 2, 5);
  std::vector<double> all;
  for (int i = 0; i < 1000; ++i) {
    JumpWaits waits;
    DrawJumpWaits(random, waits);
    all.insert(all.end(), waits.begin(), waits.end());
  }
  // False alarms: 5e-5.
  EXPECT_LT(oracle::KolmogorovSmirnov(all, [](double x) { return -std::expm1(-x); }), 2.3);
}

TEST(JumpDraws, SameBitsOnEveryTargetWithFusedMultiplyAdd) {
  std::vector<JumpAttempts> attempts;
  std::vector<JumpWaits> waits;
  ForEachFusedTarget([&] {
    CounterRandom random(1, 2, 6);
    DrawJumpAttempts(TwoKinds(), random, attempts.emplace_back());
    DrawJumpWaits(random, waits.emplace_back());
  });
  for (size_t i = 1; i < attempts.size(); ++i) {
    EXPECT_EQ(std::memcmp(&attempts[i], &attempts[0], sizeof(JumpAttempts)), 0);
    EXPECT_EQ(waits[i], waits[0]);
  }
}

}  // namespace
}  // namespace ballpiston
