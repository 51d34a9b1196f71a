#include "core/ensemble/point_fold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "tests/core/one_point_spec.h"

namespace ballpiston {
namespace {

std::unique_ptr<const PointExperiment> Point(const Target& target) {
  return PointExperiment::Create(SpecOf(&kConditionalMeanFreeTime, PaperPoint(0.02, 0.125), target),
                                 0);
}

// All blocks of a point's chunks, in order.
struct ComputedBlock {
  Block block;
  BlockResult result;
};

std::vector<ComputedBlock> BlocksOf(const PointExperiment& point) {
  std::vector<ComputedBlock> blocks;
  ChunkFold fold(point.plan(), {}, point.plan().chunks());
  while (const auto block = fold.NextBlock()) blocks.push_back({*block, *RunBlock(point, *block)});
  return blocks;
}

std::vector<ChunkResult> Fold(ChunkFold& fold, const std::vector<ComputedBlock>& blocks) {
  std::vector<ChunkResult> chunks;
  for (const ComputedBlock& computed : blocks) {
    for (ChunkResult& chunk : fold.Add(computed.block, computed.result)) {
      chunks.push_back(std::move(chunk));
    }
  }
  return chunks;
}

void ExpectEqual(const std::vector<ChunkResult>& a, const std::vector<ChunkResult>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].chunk, b[i].chunk);
    EXPECT_EQ(a[i].result, b[i].result) << "chunk " << a[i].chunk;
  }
}

class FoldTest : public testing::Test {
 protected:
  ChunkFold WholeRange() const { return {point_->plan(), PartialChunk(), point_->plan().chunks()}; }

  const std::unique_ptr<const PointExperiment> point_ = Point({.samples = 1000});
  const std::vector<ComputedBlock> blocks_ = BlocksOf(*point_);
  ChunkFold in_order_ = WholeRange();
  const std::vector<ChunkResult> chunks_ = Fold(in_order_, blocks_);
};

using ChunkFoldTest = FoldTest;
using PointFoldTest = FoldTest;

TEST_F(ChunkFoldTest, ChunksAreIndependentOfTheOrderOfBlocks) {
  ASSERT_GT(chunks_.size(), 2u);
  EXPECT_TRUE(in_order_.finished());
  auto shuffled = blocks_;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(seed));
    ChunkFold fold = WholeRange();
    while (fold.NextBlock()) continue;
    ExpectEqual(Fold(fold, shuffled), chunks_);
    EXPECT_TRUE(fold.finished());
  }
}

TEST_F(ChunkFoldTest, AResumedChunkHasTheSameBits) {
  for (size_t n = 0; n < blocks_.size(); n += 7) {
    ChunkFold before = WholeRange();
    const auto cut = blocks_.begin() + static_cast<ptrdiff_t>(n);
    std::vector<ChunkResult> chunks = Fold(before, {blocks_.begin(), cut});
    ChunkFold after(point_->plan(), before.partial(), point_->plan().chunks());
    for (auto computed = cut; computed != blocks_.end(); ++computed) {
      ASSERT_EQ(after.NextBlock(), computed->block);
      for (ChunkResult& chunk : after.Add(computed->block, computed->result)) {
        chunks.push_back(std::move(chunk));
      }
    }
    EXPECT_FALSE(after.NextBlock());
    ExpectEqual(chunks, chunks_);
  }
}

TEST_F(ChunkFoldTest, ARangeHasOnlyItsChunks) {
  ChunkFold fold(point_->plan(), {.chunk = 1}, 3);
  std::vector<ChunkResult> chunks;
  while (const auto block = fold.NextBlock()) {
    for (ChunkResult& chunk : fold.Add(*block, *RunBlock(*point_, *block))) {
      chunks.push_back(std::move(chunk));
    }
  }
  ExpectEqual(chunks, {chunks_[1], chunks_[2]});
}

TEST_F(ChunkFoldTest, ABlockCountsOnce) {
  ChunkFold fold = WholeRange();
  while (fold.NextBlock()) continue;
  for (int repeat = 0; repeat < 3; ++repeat) {
    fold.Add(blocks_[0].block, blocks_[0].result);
    fold.Add(blocks_[2].block, blocks_[2].result);
  }
  EXPECT_EQ(fold.partial().merged, blocks_[0].result);
  EXPECT_EQ(fold.waiting(), 1u);
}

TEST_F(ChunkFoldTest, BlocksHandedOutAreLimitedByTheWindow) {
  const auto endless = Point({.tolerance = 1e-5});
  ChunkFold fold(endless->plan(), {}, endless->plan().chunks());
  std::vector<Block> blocks;
  while (const auto block = fold.NextBlock()) blocks.push_back(*block);
  EXPECT_EQ(blocks.size(), ChunkFold::kWindow);
  fold.Add(blocks[1], blocks_[1].result);
  EXPECT_FALSE(fold.NextBlock());  // the first block is not yet computed
  fold.Add(blocks[0], blocks_[0].result);
  EXPECT_TRUE(fold.NextBlock());
  EXPECT_TRUE(fold.NextBlock());
  EXPECT_FALSE(fold.NextBlock());
}

TEST_F(ChunkFoldTest, TheWindowOfADeviceHoldsItsLongestOrbits) {
  const ChunkPlan plan(1'000'000'000, Engine::kLanes, 10'000);
  ASSERT_EQ(plan.MostInABlock(), 1024u);
  EXPECT_EQ(ChunkFold::WindowFor(plan, 1), ChunkFold::kWindow);
  EXPECT_EQ(ChunkFold::WindowFor(plan, 200 * 1024), 3200u);
  EXPECT_EQ(ChunkFold::WindowFor(plan, 1'000'000'000), 16 * ChunkFold::kWindow);
  ChunkFold fold(plan, {}, plan.chunks(), {}, 3200);
  uint64_t handed_out = 0;
  while (fold.NextBlock()) ++handed_out;
  EXPECT_EQ(handed_out, 3200u);
}

TEST_F(PointFoldTest, ResultIsIndependentOfArrivalOrder) {
  const BlockResult expected = *FoldPoint(*point_);
  auto shuffled = chunks_;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(seed));
    PointFold fold(*point_);
    uint64_t samples = 0;
    for (const ChunkResult& chunk : shuffled) samples += fold.Add(chunk);
    EXPECT_TRUE(fold.finished());
    EXPECT_EQ(fold.Merged(), expected);
    EXPECT_EQ(samples, 1000u);
    EXPECT_EQ(fold.PlannedSamples(), 1000u);
  }
}

TEST_F(PointFoldTest, MergingInAnotherOrderGivesOtherBits) {  // or the test above proves nothing
  BlockResult backwards;
  for (auto chunk = chunks_.rbegin(); chunk != chunks_.rend(); ++chunk) {
    backwards.Merge(chunk->result);
  }
  EXPECT_NE(backwards, *FoldPoint(*point_));
}

TEST_F(PointFoldTest, ResumedFoldGivesTheSameBits) {
  for (size_t n = 0; n <= chunks_.size(); ++n) {
    PointFold before(*point_);
    for (size_t i = 0; i < n; ++i) before.Add(chunks_[i]);
    PointFold after(*point_);
    after.Resume(before.state());
    EXPECT_EQ(after.PlannedSamples(), before.PlannedSamples());
    for (size_t i = n; i < chunks_.size(); ++i) after.Add(chunks_[i]);
    EXPECT_TRUE(after.finished());
    EXPECT_EQ(after.Merged(), *FoldPoint(*point_)) << n;
  }
}

TEST_F(PointFoldTest, EarlyChunksWait) {
  PointFold fold(*point_);
  EXPECT_TRUE(fold.Needs(1));
  EXPECT_EQ(fold.Add(chunks_[1]), 0u);
  EXPECT_FALSE(fold.Needs(1));
  EXPECT_EQ(fold.waiting(), 1u);
  EXPECT_FALSE(fold.HasBlocks());
  EXPECT_EQ(fold.Add(chunks_[0]), chunks_[0].result.samples + chunks_[1].result.samples);
  EXPECT_EQ(fold.waiting(), 0u);
}

TEST_F(PointFoldTest, AChunkCountsOnce) {
  PointFold fold(*point_);
  for (int repeat = 0; repeat < 3; ++repeat) {
    fold.Add(chunks_[0]);
    fold.Add(chunks_[2]);
  }
  EXPECT_EQ(fold.Merged(), chunks_[0].result);
}

TEST_F(PointFoldTest, TheFirstBlocksOfAChunkCountOnce) {
  PointFold fold(*point_);
  ChunkFold blocks = WholeRange();
  while (blocks.NextBlock()) continue;
  uint64_t samples = 0;
  for (size_t i = 0; i < 5; ++i) {
    for (ChunkResult& chunk : blocks.Add(blocks_[i].block, blocks_[i].result)) {
      samples += fold.Add(std::move(chunk));
    }
    for (int repeat = 0; repeat < 2; ++repeat) samples += fold.AddPartial(blocks.partial());
    EXPECT_EQ(samples, fold.Merged().samples);
  }
  EXPECT_EQ(fold.AddPartial({.chunk = 1, .blocks = 1, .merged = blocks_[0].result}), 0u);
  samples += fold.Add(chunks_[0]);
  EXPECT_EQ(samples, chunks_[0].result.samples);
  EXPECT_EQ(fold.Merged(), chunks_[0].result);
}

TEST_F(PointFoldTest, FinishKeepsMergedChunksAndDropsWaitingChunks) {
  PointFold fold(*point_);
  fold.Add(chunks_[0]);
  fold.Add(chunks_[2]);
  fold.Finish();
  fold.Add(chunks_[1]);
  EXPECT_EQ(fold.Merged(), chunks_[0].result);
  EXPECT_EQ(fold.waiting(), 0u);
  EXPECT_FALSE(fold.Needs(3));
}

TEST_F(PointFoldTest, LocalPointMatchesTheFold) {
  LocalPoint local(*point_);
  for (const ComputedBlock& computed : blocks_) {
    ASSERT_EQ(local.NextBlock(), computed.block);
    local.Add(computed.block, computed.result);
    EXPECT_EQ(local.Merged().samples, computed.block.first + computed.block.samples);
  }
  EXPECT_FALSE(local.NextBlock());
  EXPECT_EQ(local.Merged(), *FoldPoint(*point_));
}

// The tolerance is reached within a chunk; the fold continues to the chunk's end.
TEST_F(PointFoldTest, AToleranceIsJudgedAtTheEndsOfChunks) {
  const auto point = Point({.tolerance = 0.1});
  const uint64_t samples = FoldPoint(*point)->samples;
  EXPECT_GT(samples, 64u);
  uint64_t chunk = 0;
  while (point->plan().FirstSample(chunk) < samples) ++chunk;
  EXPECT_EQ(point->plan().FirstSample(chunk), samples);
  EXPECT_TRUE(point->ReachesTolerance(*FoldPoint(*point)));
}

// A sample takes hours here, so that a chunk has one sample. All samples agree, but the tolerance
// is judged after 64.
TEST_F(PointFoldTest, AToleranceOfLongSamplesIsJudgedAfter64) {
  const auto point =
      PointExperiment::Create(SpecOf(&kConditionalMeanFreeTime, PaperPoint(1e-6, 0.125),
                                     {.tolerance = 0.5}, Model::kBilliard),
                              0);
  ASSERT_EQ(point->plan().SamplesIn(0), 1u);
  PointFold fold(*point);
  for (uint64_t chunk = 0; chunk < 64; ++chunk) {
    EXPECT_FALSE(fold.finished()) << chunk;
    BlockResult one = point->EmptyResult();
    one.samples = 1;
    one.moments[0].Add(chunk % 2 == 0 ? 1 : 1.1);
    fold.Add({chunk, one});
  }
  EXPECT_TRUE(fold.finished());
  EXPECT_TRUE(point->ReachesTolerance(fold.Merged()));
}

TEST_F(PointFoldTest, StopEndsIt) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(FoldPoint(*Point({.tolerance = 1e-5}), stop.get_token()));
}

}  // namespace
}  // namespace ballpiston
