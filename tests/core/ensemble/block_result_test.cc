#include "core/ensemble/block_result.h"

#include <gtest/gtest.h>

namespace ballpiston {
namespace {

BlockResult Sample(double x) {
  BlockResult result;
  result.samples = 2;
  result.moments.resize(1);
  result.moments[0].Add(x);
  result.moments[0].Add(2 * x);
  result.batch_means.resize(1);
  result.batch_means[0].Add(x, 2);
  result.histograms = {Histogram::OfBins(0, 10, 10)};
  result.histograms[0].Add(x);
  result.histograms[0].Add(2 * x);
  result.health = {.escapes = 1, .max_energy_error = x};
  return result;
}

TEST(BlockResult, MergeWithEmptyIsIdentity) {
  const BlockResult whole = Sample(1);
  BlockResult left, right = whole;
  left.Merge(whole);
  right.Merge({});
  EXPECT_EQ(left, whole);
  EXPECT_EQ(right, whole);
}

TEST(BlockResult, MergeKeepsEverySample) {
  BlockResult merged = Sample(1);
  merged.Merge(Sample(2));
  EXPECT_EQ(merged.samples, 4u);
  EXPECT_EQ(merged.moments[0].count, 4u);
  EXPECT_DOUBLE_EQ(merged.moments[0].mean, (1 + 2 + 2 + 4) / 4.0);
  EXPECT_EQ(merged.batch_means[0].batches, 2u);
  EXPECT_EQ(merged.histograms[0].counts, (std::vector<uint64_t>{0, 1, 2, 0, 1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(merged.health.escapes, 2u);
  EXPECT_EQ(merged.health.max_energy_error, 2);
}

TEST(BlockResult, ShapesDifferInNumbersAndBins) {
  const BlockResult block = Sample(1);
  EXPECT_TRUE(Sample(2).HasShapeOf(block));
  BlockResult moments = block, means = block, histograms = block, bins = block, range = block;
  moments.moments.emplace_back();
  means.batch_means.clear();
  histograms.histograms.push_back(block.histograms[0]);
  bins.histograms[0].counts.pop_back();
  range.histograms[0].upper = 11;
  for (const BlockResult& other : {moments, means, histograms, bins, range}) {
    EXPECT_FALSE(other.HasShapeOf(block));
    EXPECT_FALSE(block.HasShapeOf(other));
  }
}

}  // namespace
}  // namespace ballpiston
