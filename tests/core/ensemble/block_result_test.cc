#include "core/ensemble/block_result.h"

#include "tests/core/preamble.h"

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
  result.groups = {{}, GroupState({x, 2})};
  return result;
}

// The newer state of a group replaces the older one.
TEST(BlockResult, MergeKeepsEverySampleAndHasAnIdentity) {
  BlockResult merged;
  merged.Merge(Sample(1));
  EXPECT_EQ(merged, Sample(1));
  merged.Merge({});
  EXPECT_EQ(merged, Sample(1));
  merged.groups[0] = GroupState({7});
  merged.Merge(Sample(2));
  EXPECT_EQ(merged.samples, 4u);
  EXPECT_EQ(merged.moments[0].count, 4u);
  EXPECT_DOUBLE_EQ(merged.moments[0].mean, (1 + 2 + 2 + 4) / 4.0);
  EXPECT_EQ(merged.batch_means[0].batches(), 2u);
  EXPECT_EQ(merged.histograms[0].counts, (std::vector<uint64_t>{0, 1, 2, 0, 1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(merged.health.escapes, 2u);
  EXPECT_EQ(merged.health.max_energy_error, 2);
  EXPECT_EQ(merged.groups, (std::vector<GroupState>{GroupState({7}), GroupState({2, 2})}));
}

struct Change {
  const char* what;
  void (*change)(BlockResult&);
  bool of_shape = false;
};

// Numbers are compared by defaulted operators; only GroupState has its own.
const Change kChanges[] = {
    {"a bin", [](BlockResult& r) { r.histograms[0].counts[2] += 1; }},
    {"a group's state",
     [](BlockResult& r) {
       r.groups[1] = GroupState({1, 3});
     }},
    {"the upper end", [](BlockResult& r) { r.histograms[0].upper = 11; }, true},
    {"one bin more", [](BlockResult& r) { r.histograms[0].counts.push_back(0); }, true},
    {"other moments", [](BlockResult& r) { r.moments.emplace_back(); }, true},
    {"no batch means", [](BlockResult& r) { r.batch_means.clear(); }, true},
    {"no histograms", [](BlockResult& r) { r.histograms.clear(); }, true},
    {"one group less", [](BlockResult& r) { r.groups.pop_back(); }, true},
};

TEST(BlockResult, EqualResultsHaveEqualNumbersAndShapes) {
  const BlockResult before = Sample(1);
  for (const Change& change : kChanges) {
    SCOPED_TRACE(change.what);
    BlockResult changed = before;
    change.change(changed);
    EXPECT_NE(changed, before);
    EXPECT_EQ(changed.HasShapeOf(before), !change.of_shape);
    EXPECT_EQ(before.HasShapeOf(changed), !change.of_shape);
  }
}

}  // namespace
}  // namespace ballpiston
