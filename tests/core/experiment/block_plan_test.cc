#include "core/experiment/block_plan.h"

#include <gtest/gtest.h>

#include <bit>

namespace ballpiston {
namespace {

EnsembleSpec With(const Target& target) { return {.target = target}; }

TEST(BlockPlan, CoversEverySampleOnce) {
  for (const int64_t samples : {1, 2, 63, 64, 65, 1000, 1'000'003}) {
    for (const double events : {1.0, 37.0, 1e4, 1e9}) {
      const BlockPlan plan = PlanBlocks(With({.samples = samples}), events);
      uint64_t covered = 0;
      for (uint64_t block = 0; block < plan.Blocks(); ++block) {
        ASSERT_EQ(plan.FirstSample(block), covered);
        ASSERT_GE(plan.SamplesIn(block), 1u);
        covered += plan.SamplesIn(block);
      }
      EXPECT_EQ(covered, static_cast<uint64_t>(samples));
    }
  }
}

TEST(BlockPlan, SizeIsAPowerOfTwoThatLeavesEnoughBlocks) {
  for (const int64_t samples : {64, 1000, 1'000'003}) {
    const BlockPlan plan = PlanBlocks(With({.collisions = samples}), 50);
    EXPECT_TRUE(std::has_single_bit(plan.block_size));
    EXPECT_GE(plan.Blocks(), kMinBlocks);
  }
}

TEST(BlockPlan, ExpensiveSamplesMakeSmallBlocks) {
  EXPECT_EQ(PlanBlocks(With({.samples = 1'000'000}), 1e9).block_size, 1u);
  EXPECT_EQ(PlanBlocks(With({.samples = 1'000'000'000}), 0x1p15).block_size, 1024u);
}

TEST(BlockPlan, NoTargetAsksForTheDefault) {
  EXPECT_EQ(PlanBlocks(With({}), 1).samples, static_cast<uint64_t>(kDefaultSamples));
}

TEST(BlockPlan, ToleranceMayGoOnToTheLargestCount) {
  const BlockPlan plan = PlanBlocks(With({.tolerance = 0.01}), 100);
  EXPECT_EQ(plan.samples, static_cast<uint64_t>(kMaxSamples));
  EXPECT_EQ(plan.tolerance, 0.01);
}

TEST(BlockPlan, OpenEndsHaveSmallerBlocks) {
  const uint64_t counted = PlanBlocks(With({.samples = kMaxSamples}), 0x1p15).block_size;
  for (const Target& target : {Target{.tolerance = 0.01}, Target{.budget_seconds = 100}}) {
    const BlockPlan plan = PlanBlocks(With(target), 0x1p15);
    EXPECT_EQ(plan.block_size, counted / 8);
    EXPECT_EQ(plan.samples, static_cast<uint64_t>(kMaxSamples));
  }
}

// At some 3e8 events a second in lanes, and a fifteenth of that by the reference.
TEST(BlockPlan, ABudgetHasSeveralBlocks) {
  for (const Model model : {Model::kBilliard, Model::kBilliardReference}) {
    EnsembleSpec spec = With({.budget_seconds = 1e-3});
    spec.model = model;
    const double events = static_cast<double>(PlanBlocks(spec, 10).block_size) * 10;
    const double speed = model == Model::kBilliard ? 3e8 : 2e7;
    EXPECT_LE(events, speed * 1e-3 / 8);
    EXPECT_GT(events, speed * 1e-3 / 8 / 2);
  }
}

TEST(BlockPlan, CollisionsAreSharedByTheOrbitsThatTakeThem) {
  EXPECT_EQ(SamplesAskedFor({.collisions = 1000}, 40), 25u);
  EXPECT_EQ(SamplesAskedFor({.collisions = 1001}, 40), 26u);
  EXPECT_EQ(SamplesAskedFor({.collisions = 1}, 40), 1u);
  EXPECT_EQ(SamplesAskedFor({.samples = 1000}, 40), 1000u);
  EXPECT_EQ(SamplesAskedFor({}, 40), static_cast<uint64_t>(kDefaultSamples));
}

TEST(BlockPlan, AnAnswerWithoutSamplesHasNoBlocks) {
  EXPECT_EQ(BlockPlan{.samples = 0}.Blocks(), 0u);
}

}  // namespace
}  // namespace ballpiston
