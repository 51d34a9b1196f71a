#include "core/ensemble/block_result.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>
#include <vector>

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

TEST(BlockResult, TheNewerStateOfAGroupReplacesTheOlder) {
  BlockResult merged, first, second;
  first.groups = {GroupState({1}), GroupState({2}), {}};
  second.groups = {{}, GroupState({3}), GroupState({4})};
  merged.Merge(first);
  merged.Merge(second);
  EXPECT_EQ(merged.groups,
            (std::vector<GroupState>{GroupState({1}), GroupState({3}), GroupState({4})}));
}

TEST(BlockResult, ShapesDifferInNumbersAndBins) {
  const BlockResult block = Sample(1);
  EXPECT_TRUE(Sample(2).HasShapeOf(block));
  BlockResult moments = block, means = block, histograms = block, bins = block, range = block,
              groups = block;
  groups.groups.emplace_back();
  moments.moments.emplace_back();
  means.batch_means.clear();
  histograms.histograms.push_back(block.histograms[0]);
  bins.histograms[0].counts.pop_back();
  range.histograms[0].upper = 11;
  for (const BlockResult& other : {moments, means, histograms, bins, range, groups}) {
    EXPECT_FALSE(other.HasShapeOf(block));
    EXPECT_FALSE(block.HasShapeOf(other));
  }
}

BlockResult Digested() {
  BlockResult result;
  result.samples = 3;
  result.moments = {{1, 2, 3, 4, 5}, {6, 7, 8, 9, 10}};
  result.batch_means = {{1, 2, 3, 4, 5, 6}};
  result.histograms = {{0, 1, {1, 2, 3}}};
  result.health = {.escapes = 1, .max_energy_error = 1e-15};
  result.groups = {{}, GroupState({1, 2})};
  return result;
}

TEST(BlockDigest, EveryNumberChangesTheDigest) {
  std::vector<BlockResult> changed(16, Digested());
  changed[0].samples ^= 1;
  changed[1].moments[1].count ^= uint64_t{1} << 63;
  changed[2].moments[1].mean = -changed[2].moments[1].mean;
  changed[3].moments[0].m4 += 1e-15 * changed[3].moments[0].m4;
  changed[4].batch_means[0].batches += 1;
  changed[5].batch_means[0].c_dd += 1;
  changed[6].histograms[0].lower = -0.0;
  changed[7].histograms[0].upper = 2;
  changed[8].histograms[0].counts[2] += 1;
  changed[9].histograms[0].counts.push_back(0);
  changed[10].health.escapes = 0;
  changed[11].health.max_energy_error = 2e-15;
  changed[12].moments.pop_back();
  changed[13].histograms.clear();
  changed[14].groups[1] = GroupState({1, 3});
  changed[15].groups.pop_back();
  std::set<uint64_t> digests = {DigestOf(Digested())};
  for (const BlockResult& result : changed) digests.insert(DigestOf(result));
  EXPECT_EQ(digests.size(), changed.size() + 1);
  EXPECT_EQ(DigestOf(Digested()), DigestOf(Digested()));
}

TEST(BlockDigest, NumbersInAnotherOrderHaveAnotherDigest) {
  BlockResult swapped = Digested(), counts = Digested();
  std::swap(swapped.moments[0], swapped.moments[1]);
  std::swap(counts.histograms[0].counts[0], counts.histograms[0].counts[1]);
  EXPECT_NE(DigestOf(swapped), DigestOf(Digested()));
  EXPECT_NE(DigestOf(counts), DigestOf(Digested()));
}

}  // namespace
}  // namespace ballpiston
