#include "core/gas/jump_draws.h"

#include <cstring>

#include "tests/core/billiard/each_target.h"
#include "tests/core/preamble.h"
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

// A ball proposes with the weight of a positive cosine, so the sine is uniform. A piston's proposal
// meets uniform angles. False alarms: 5e-5 each.
TEST(JumpDraws, ProposalsHaveTheirLaws) {
  CounterRandom random(1, 2, 5);
  std::vector<double> sines, angles, waits;
  for (int i = 0; i < 1000; ++i) {
    JumpProposals proposals;
    DrawJumpProposals(random, proposals);
    for (size_t j = 0; j < kJumpDraws; ++j) {
      const double weighted = proposals.cosines[0][j];
      ASSERT_GT(weighted, 0);
      sines.push_back(std::sqrt(1 - weighted * weighted));
      angles.push_back(std::acos(proposals.cosines[1][j]) / std::numbers::pi);
      waits.push_back(proposals.waits[j]);
    }
  }
  const auto uniform = [](double x) { return x; };
  EXPECT_LT(oracle::KolmogorovSmirnov(sines, uniform), 2.3);
  EXPECT_LT(oracle::KolmogorovSmirnov(angles, uniform), 2.3);
  EXPECT_LT(oracle::KolmogorovSmirnov(waits, [](double x) { return -std::expm1(-x); }), 2.3);
}

}  // namespace
}  // namespace ballpiston
