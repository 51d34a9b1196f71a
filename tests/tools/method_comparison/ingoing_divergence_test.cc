#include "tools/method_comparison/ingoing_divergence.h"

#include "tests/core/preamble.h"

namespace ballpiston::method_comparison {
namespace {

TEST(IngoingDivergence, ProbabilitiesAreThoseOfAllCells) {
  EXPECT_EQ(IngoingProbabilities(0.125).size(), 2000);
  EXPECT_EQ(IngoingProbabilities(0.3).size(), 1000);
  for (const double epsilon : {0.01, 0.125, 0.3}) {
    const std::vector<double> cells = IngoingProbabilities(epsilon);
    EXPECT_NEAR(std::accumulate(cells.begin(), cells.end(), 0.0), 1, 1e-13);
  }
}

TEST(IngoingDivergence, CountsAreInTheOrderOfTheProbabilities) {
  IngoingCounts counts(0.125);
  counts.Add({.direction = {1, 1e-9}, .sigma = -1});
  counts.Add({.direction = {1, 1e-9}, .sigma = +1});
  EXPECT_EQ(counts.Counts().size(), 2000);
  EXPECT_EQ(counts.Counts()[500], 1);
  EXPECT_EQ(counts.Counts()[1500], 1);
}

}  // namespace
}  // namespace ballpiston::method_comparison
