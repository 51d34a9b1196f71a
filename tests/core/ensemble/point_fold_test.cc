#include "core/ensemble/point_fold.h"

#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

std::unique_ptr<const PointExperiment> Point(const Target& target, double delta = 0.02) {
  return PointExperiment::Create(
      SpecOf(&kConditionalMeanFreeTime, PaperPoint(delta, 0.125), target, Model::kBilliard), 0);
}

// The blocks of a point of 1000 samples and their chunks, both in order.
class Fold : public testing::Test {
 protected:
  struct Computed {
    Block block;
    BlockResult result;
  };

  Fold() {
    ChunkFold fold = AllChunks();
    while (const auto block = fold.NextBlock()) {
      blocks_.push_back({*block, RunBlock(*point_, *block)});
      Add(fold, blocks_.back(), chunks_);
    }
    EXPECT_TRUE(fold.finished());
    EXPECT_GT(chunks_.size(), 2u);
  }

  ChunkFold AllChunks(const PartialChunk& begun = {}) const {
    return {point_->plan(), begun, point_->plan().chunks()};
  }
  // All blocks are given out.
  ChunkFold GivenOut() const {
    ChunkFold fold = AllChunks();
    while (fold.NextBlock()) continue;
    return fold;
  }
  static void Add(ChunkFold& fold, const Computed& computed, std::vector<ChunkResult>& chunks) {
    for (ChunkResult& chunk : fold.Add(computed.block, computed.result)) {
      chunks.push_back(std::move(chunk));
    }
  }
  void ExpectChunks(const std::vector<ChunkResult>& found) const {
    ASSERT_EQ(found.size(), chunks_.size());
    for (size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].chunk, chunks_[i].chunk);
      EXPECT_EQ(found[i].result, chunks_[i].result) << "chunk " << i;
    }
  }

  const std::unique_ptr<const PointExperiment> point_ = Point({.samples = 1000});
  std::vector<Computed> blocks_;
  std::vector<ChunkResult> chunks_;
};

TEST_F(Fold, BlocksAndChunksInAnyOrderGiveTheSameBits) {
  const BlockResult expected = FoldPoint(*point_);
  auto blocks = blocks_;
  auto arrived = chunks_;
  blocks.insert(blocks.end(), blocks_.begin(), blocks_.end());  // each counts once
  arrived.insert(arrived.end(), chunks_.begin(), chunks_.end());
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::shuffle(blocks.begin(), blocks.end(), random);
    std::shuffle(arrived.begin(), arrived.end(), random);
    ChunkFold fold = GivenOut();
    std::vector<ChunkResult> chunks;
    for (const Computed& block : blocks) Add(fold, block, chunks);
    ExpectChunks(chunks);
    EXPECT_TRUE(fold.finished());
    EXPECT_EQ(fold.waiting(), 0u);
    PointFold point(*point_);
    uint64_t samples = 0;
    for (const ChunkResult& chunk : arrived) samples += point.Add(chunk);
    EXPECT_TRUE(point.finished());
    EXPECT_EQ(point.waiting(), 0u);
    EXPECT_EQ(point.Merged(), expected);
    EXPECT_EQ(samples, 1000u);
    EXPECT_EQ(point.PlannedSamples(), 1000u);
  }
  // Merging in another order gives other bits, or the comparisons above would prove nothing.
  BlockResult backwards;
  for (auto chunk = chunks_.rbegin(); chunk != chunks_.rend(); ++chunk) {
    backwards.Merge(chunk->result);
  }
  EXPECT_NE(backwards, expected);
}

TEST_F(Fold, TheFirstBlocksOfAChunkCountOnce) {
  PointFold fold(*point_);
  ChunkFold blocks = GivenOut();
  uint64_t samples = 0;
  for (size_t i = 0; i < 5; ++i) {
    for (ChunkResult& chunk : blocks.Add(blocks_[i].block, blocks_[i].result)) {
      samples += fold.Add(std::move(chunk));
    }
    for (int repeat = 0; repeat < 2; ++repeat) samples += fold.AddPartial(blocks.partial());
    EXPECT_EQ(samples, fold.Merged().samples);
  }
  const BlockResult merged = fold.Merged();
  for (const uint64_t chunk : {0u, 1u}) {  // fewer blocks than are known; of a later chunk
    fold.AddPartial({.chunk = chunk, .blocks = 1, .merged = blocks_[0].result});
    EXPECT_EQ(fold.Merged(), merged);
  }
  samples += fold.Add(chunks_[0]);
  EXPECT_EQ(samples, chunks_[0].result.samples);
  EXPECT_EQ(fold.Merged(), chunks_[0].result);
}

TEST_F(Fold, BlocksGivenOutAreLimitedByTheWindow) {
  const auto endless = Point({.tolerance = 1e-5});
  ChunkFold fold(endless->plan(), {}, endless->plan().chunks());
  std::vector<Block> blocks;
  while (const auto block = fold.NextBlock()) blocks.push_back(*block);
  EXPECT_EQ(blocks.size(), ChunkFold::kWindow);
  fold.Add(blocks[1], blocks_[1].result);
  EXPECT_FALSE(fold.NextBlock());  // the first block is not yet computed
  fold.Add(blocks[0], blocks_[0].result);
  for (const bool has_more : {true, true, false}) EXPECT_EQ(fold.NextBlock().has_value(), has_more);
}

TEST_F(Fold, TheWindowOfADeviceHoldsItsLongestOrbits) {
  const ChunkPlan plan(1'000'000'000, Engine::kLanes, 10'000);
  ASSERT_EQ(plan.MostInABlock(), 1024u);
  EXPECT_EQ(ChunkFold::WindowFor(plan, 1), ChunkFold::kWindow);
  EXPECT_EQ(ChunkFold::WindowFor(plan, 200 * 1024), ChunkFold::kWindow + 3200);
  EXPECT_EQ(ChunkFold::WindowFor(plan, 1'000'000'000), 16 * ChunkFold::kWindow);
  ChunkFold fold(plan, {}, plan.chunks(), {}, 3200);
  uint64_t given_out = 0;
  while (fold.NextBlock()) ++given_out;
  EXPECT_EQ(given_out, 3200u);
}

TEST_F(Fold, FinishKeepsMergedChunksAndDropsWaitingChunks) {
  PointFold fold(*point_);
  fold.Add(chunks_[0]);
  fold.Add(chunks_[2]);
  fold.Finish();
  fold.Add(chunks_[1]);
  EXPECT_EQ(fold.Merged(), chunks_[0].result);
  EXPECT_EQ(fold.waiting(), 0u);
  EXPECT_FALSE(fold.Needs(3));
}

// A sample takes hours here, so that a chunk has one sample. All samples agree, but the tolerance
// is judged after 64.
TEST(PointFold, AToleranceOfLongSamplesIsJudgedAfter64) {
  const auto point = Point({.tolerance = 0.5}, 1e-6);
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
  PointFold resumed(*point);
  resumed.Resume(fold.state());
  EXPECT_TRUE(resumed.finished());
}

}  // namespace
}  // namespace ballpiston
