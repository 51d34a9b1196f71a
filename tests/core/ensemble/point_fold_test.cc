#include "core/ensemble/point_fold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "tests/core/one_point_spec.h"

namespace ballpiston {
namespace {

class PointFoldTest : public testing::Test {
 protected:
  static std::unique_ptr<const PointExperiment> Point(const Target& target) {
    return PointExperiment::Create(
        SpecOf(&kConditionalMeanFreeTime, PaperPoint(0.02, 0.125), target), 0);
  }

  // All blocks of a plan, by the order in which they are handed out.
  static std::vector<std::pair<Block, BlockResult>> AllBlocks(const PointExperiment& point) {
    std::vector<std::pair<Block, BlockResult>> blocks;
    PointFold fold(point);
    while (const auto block = fold.NextBlock()) {
      blocks.emplace_back(*block, *RunBlock(point, *block));
    }
    return blocks;
  }

  const std::unique_ptr<const PointExperiment> point_ = Point({.samples = 1000});
  const std::vector<std::pair<Block, BlockResult>> blocks_ = AllBlocks(*point_);
};

TEST_F(PointFoldTest, ResultIsIndependentOfArrivalOrder) {
  ASSERT_GT(point_->plan().chunks(), 2u);
  const BlockResult expected = *FoldPoint(*point_);
  auto shuffled = blocks_;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(seed));
    PointFold fold(*point_);
    uint64_t samples = 0;
    for (const auto& [block, result] : shuffled) samples += fold.Add(block, result);
    EXPECT_TRUE(fold.finished());
    EXPECT_EQ(fold.Merged(), expected);
    EXPECT_EQ(samples, 1000u);
    EXPECT_EQ(fold.PlannedSamples(), 1000u);
  }
}

TEST_F(PointFoldTest, MergingInAnotherOrderGivesOtherBits) {  // or the test above proves nothing
  BlockResult backwards;
  for (auto block = blocks_.rbegin(); block != blocks_.rend(); ++block) {
    backwards.Merge(block->second);
  }
  EXPECT_NE(backwards, *FoldPoint(*point_));
}

TEST_F(PointFoldTest, ResumedFoldGivesTheSameBits) {
  const BlockResult expected = *FoldPoint(*point_);
  for (size_t n = 0; n <= blocks_.size(); n += 7) {
    PointFold before(*point_);
    for (size_t i = 0; i < n; ++i) before.Add(blocks_[i].first, blocks_[i].second);
    PointFold after(*point_);
    after.Resume(before.state());
    EXPECT_EQ(after.PlannedSamples(), before.PlannedSamples());
    size_t i = n;
    while (const auto block = after.NextBlock()) {
      ASSERT_EQ(*block, blocks_[i].first);
      after.Add(*block, blocks_[i++].second);
    }
    EXPECT_TRUE(after.finished());
    EXPECT_EQ(after.Merged(), expected) << n;
  }
}

TEST_F(PointFoldTest, EarlyBlocksWait) {
  PointFold fold(*point_);
  EXPECT_EQ(fold.Add(blocks_[1].first, blocks_[1].second), 0u);
  EXPECT_EQ(fold.waiting(), 1u);
  EXPECT_FALSE(fold.HasBlocks());
  EXPECT_EQ(fold.Add(blocks_[0].first, blocks_[0].second),
            blocks_[0].first.samples + blocks_[1].first.samples);
  EXPECT_EQ(fold.waiting(), 0u);
}

TEST_F(PointFoldTest, ABlockCountsOnce) {
  PointFold fold(*point_);
  for (int repeat = 0; repeat < 3; ++repeat) {
    fold.Add(blocks_[0].first, blocks_[0].second);
    fold.Add(blocks_[2].first, blocks_[2].second);
  }
  EXPECT_EQ(fold.Merged(), blocks_[0].second);
}

TEST_F(PointFoldTest, FinishKeepsWhatIsMergedAndDropsWhatWaits) {
  PointFold fold(*point_);
  fold.Add(blocks_[0].first, blocks_[0].second);
  fold.Add(blocks_[2].first, blocks_[2].second);
  fold.Finish();
  fold.Add(blocks_[1].first, blocks_[1].second);
  EXPECT_EQ(fold.Merged(), blocks_[0].second);
  EXPECT_EQ(fold.waiting(), 0u);
  EXPECT_FALSE(fold.NextBlock());
}

TEST_F(PointFoldTest, NoMoreBlocksAreHandedOutThanTheWindowHolds) {
  const auto endless = Point({.tolerance = 1e-5});
  PointFold fold(*endless);
  std::vector<Block> blocks;
  while (const auto block = fold.NextBlock()) blocks.push_back(*block);
  EXPECT_EQ(blocks.size(), PointFold::kWindow);
  fold.Add(blocks[1], blocks_[1].second);
  EXPECT_FALSE(fold.NextBlock());  // the first one is still out
  fold.Add(blocks[0], blocks_[0].second);
  EXPECT_TRUE(fold.NextBlock());
  EXPECT_TRUE(fold.NextBlock());
  EXPECT_FALSE(fold.NextBlock());
}

// It is reached within a chunk; the fold goes on to the chunk's end.
TEST_F(PointFoldTest, AToleranceIsJudgedAtTheEndsOfChunks) {
  const auto point = Point({.tolerance = 0.1});
  const uint64_t samples = FoldPoint(*point)->samples;
  EXPECT_GT(samples, 64u);
  uint64_t chunk = 0;
  while (point->plan().FirstSample(chunk) < samples) ++chunk;
  EXPECT_EQ(point->plan().FirstSample(chunk), samples);
  EXPECT_TRUE(point->ReachesTolerance(*FoldPoint(*point)));
}

TEST_F(PointFoldTest, StopEndsIt) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(FoldPoint(*Point({.tolerance = 1e-5}), stop.get_token()));
}

}  // namespace
}  // namespace ballpiston
