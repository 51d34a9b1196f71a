#include "core/statistics/group_scatter.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

TEST(GroupScatter, VarianceOfASumIsThatOfItsGroups) {
  std::vector<Histogram> groups(kGroups, Histogram::OfBins(0, 1, 2));
  for (size_t g = 0; g < kGroups; ++g) groups[g].counts = {g % 2 == 0 ? 3u : 1u, 0};
  const std::vector<double> weights = {1, 1};
  std::vector<Histogram> balanced = groups;
  for (size_t g = 0; g < kGroups; ++g) balanced[g].counts[1] = g % 2 == 0 ? 1 : 3;
  // Deviations of +2 and -2 in each group.
  const std::vector<double> difference = {1, -1};
  EXPECT_DOUBLE_EQ(VarianceBetweenGroups(balanced, difference), 16 * 16 / 15.0 * 4);
  EXPECT_FALSE(HaveSamples(std::vector<Histogram>(kGroups, Histogram::OfBins(0, 1, 2))));
  EXPECT_TRUE(HaveSamples(groups));
  EXPECT_DOUBLE_EQ(FreedomOfSum(1, 5, 0, 7), 5);
  EXPECT_DOUBLE_EQ(FreedomOfSum(1, 5, 1, 5), 10);
}

}  // namespace
}  // namespace ballpiston
