#include "server/execution/ordered_merge.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "gtest/gtest.h"
#include "tests/server/fake_experiments.h"

namespace ballpiston::server {
namespace {

constexpr uint64_t kMergedBlocks = 50;

std::shared_ptr<const PointExperiment> ExperimentOfBlocks() {
  return FakeExperiments()(FakeSpec(1, kMergedBlocks), 0, std::stop_token());
}

std::vector<uint64_t> Shuffled(unsigned seed) {
  std::vector<uint64_t> order(kMergedBlocks);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return order;
}

TEST(OrderedMerge, ResultIsIndependentOfArrivalOrder) {
  const auto experiment = ExperimentOfBlocks();
  const BlockResult expected = FakeMerged(FakeSpec(1, kMergedBlocks), 0, kMergedBlocks);
  for (unsigned seed = 0; seed < 20; ++seed) {
    OrderedMerge merge(experiment);
    std::vector<uint64_t> merged;
    for (const uint64_t block : Shuffled(seed)) {
      merge.Add(block, *experiment->RunBlock(block, {}),
                [&](uint64_t index, BlockResult&) { merged.push_back(index); });
    }
    EXPECT_TRUE(merge.finished());
    EXPECT_TRUE(merge.merged() == expected) << "arrival order " << seed;
    EXPECT_TRUE(std::is_sorted(merged.begin(), merged.end()));
    EXPECT_EQ(merged.size(), kMergedBlocks);
  }
}

TEST(OrderedMerge, MergingInAnotherOrderGivesOtherBits) {  // or the test above proves nothing
  const auto experiment = ExperimentOfBlocks();
  BlockResult backwards;
  for (uint64_t block = kMergedBlocks; block-- > 0;)
    backwards.Merge(*experiment->RunBlock(block, {}));
  EXPECT_FALSE(backwards == FakeMerged(FakeSpec(1, kMergedBlocks), 0, kMergedBlocks));
}

TEST(OrderedMerge, EarlyBlocksWait) {
  const auto experiment = ExperimentOfBlocks();
  OrderedMerge merge(experiment);
  merge.Add(1, *experiment->RunBlock(1, {}), nullptr);
  EXPECT_EQ(merge.blocks_merged(), 0u);
  EXPECT_EQ(merge.waiting(), 1u);
  EXPECT_TRUE(merge.Knows(1));
  EXPECT_FALSE(merge.Knows(0));
  merge.Add(0, *experiment->RunBlock(0, {}), nullptr);
  EXPECT_EQ(merge.blocks_merged(), 2u);
  EXPECT_EQ(merge.waiting(), 0u);
}

TEST(OrderedMerge, ABlockCountsOnce) {
  const auto experiment = ExperimentOfBlocks();
  OrderedMerge merge(experiment);
  for (int repeat = 0; repeat < 3; ++repeat) {
    merge.Add(0, *experiment->RunBlock(0, {}), nullptr);
    merge.Add(2, *experiment->RunBlock(2, {}), nullptr);
  }
  EXPECT_EQ(merge.blocks_merged(), 1u);
  EXPECT_EQ(merge.merged().samples, kFakeSamplesPerBlock);
}

TEST(OrderedMerge, FinishKeepsThePrefixAndDropsWaitingBlocks) {
  const auto experiment = ExperimentOfBlocks();
  OrderedMerge merge(experiment);
  for (const uint64_t block : {0u, 1u, 3u, 4u}) {
    merge.Add(block, *experiment->RunBlock(block, {}), nullptr);
  }
  merge.Finish();
  EXPECT_TRUE(merge.finished());
  EXPECT_EQ(merge.waiting(), 0u);
  merge.Add(2, *experiment->RunBlock(2, {}), nullptr);  // came too late
  EXPECT_EQ(merge.blocks_merged(), 2u);
  EXPECT_TRUE(merge.merged() == FakeMerged(FakeSpec(1, kMergedBlocks), 0, 2));
}

TEST(OrderedMerge, APlanWithoutBlocksIsFinishedAtOnce) {
  const std::shared_ptr<const PointExperiment> computed =
      FakeExperiments()(FakeSpec(1, 0), 0, std::stop_token());
  ASSERT_EQ(computed->plan().Blocks(), 0u);
  OrderedMerge merge(computed);
  EXPECT_TRUE(merge.finished());
  EXPECT_TRUE(merge.merged() == BlockResult());
}

TEST(OrderedMerge, BlocksBeyondTheToleranceAreDropped) {
  EnsembleSpec spec = FakeSpec(1, 0);
  spec.target = {};
  spec.target.tolerance = 0.05;  // reached after some 140 samples, never before kMinBlocks
  const std::shared_ptr<const PointExperiment> experiment =
      FakeExperiments()(spec, 0, std::stop_token());
  OrderedMerge merge(experiment);
  uint64_t told = 0;
  for (uint64_t block = 200; block-- > 0;) {  // backwards: all wait for the first
    merge.Add(block, *experiment->RunBlock(block, {}), [&](uint64_t, BlockResult&) { ++told; });
  }
  EXPECT_TRUE(merge.finished());
  EXPECT_GE(merge.blocks_merged(), kMinBlocks);
  EXPECT_LT(merge.blocks_merged(), 200u);
  EXPECT_EQ(told, merge.blocks_merged());
  EXPECT_EQ(merge.waiting(), 0u);
  EXPECT_TRUE(merge.merged() == FakeMerged(spec, 0, merge.blocks_merged()));
}

}  // namespace
}  // namespace ballpiston::server
