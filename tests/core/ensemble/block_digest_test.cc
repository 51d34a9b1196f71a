#include "core/ensemble/block_digest.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>
#include <vector>

namespace ballpiston {
namespace {

BlockResult Digested() {
  BlockResult result;
  result.samples = 3;
  result.moments = {{1, 2, 3, 4, 5}, {6, 7, 8, 9, 10}};
  result.batch_means = {{1, 2, 3, 4, 5, 6}};
  result.histograms = {{0, 1, {1, 2, 3}}};
  result.health = {.escapes = 1, .max_energy_error = 1e-15};
  return result;
}

TEST(BlockDigest, EveryNumberChangesTheDigest) {
  std::vector<BlockResult> changed(14, Digested());
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
