// Return times at fixed energies: their errors, and where there are none.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "core/geometry/pair_geometry.h"
#include "core/statistics/moments.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

EnsembleSpec SpecOfReturns(double share, double epsilon, int64_t samples, uint64_t seed) {
  return SpecOf(Experiment::kConditionalMeanFreeTime,
                PaperPoint(share * PairDeltaBound(kPaperRho), epsilon), {.samples = samples},
                Model::kBilliard, seed);
}

// A resting piston: the variance is infinite, but only just (its integral grows as the logarithm of
// the sample's size), so the mean of 1e5 samples is within some percent of that of the volume which
// is visited, and far from the limit of slow pistons, 14 times as large.
TEST(ConditionalMeanFreeTime, OfARestingPistonHasNoErrorButTheRightMean) {
  const PointSummary summary = RunPoint(SpecOfReturns(0.2, 0, 100'000, 4));
  ASSERT_EQ(summary.estimates.size(), 1u);
  EXPECT_FALSE(summary.estimates[0].standard_error);
  EXPECT_NEAR(summary.estimates[0].value / *summary.estimates[0].exact, 1, 0.1);
}

// A piston so slow that its round trips, which carry the mean, are not in the sample.
TEST(ConditionalMeanFreeTime, GivesNoErrorWhereLongReturnsAreNotSeen) {
  const PointSummary summary = RunPoint(SpecOfReturns(0.3, 1e-12, 10'000, 4));
  EXPECT_FALSE(summary.estimates[0].standard_error);
  EXPECT_LT(summary.estimates[0].value, 0.5 * *summary.estimates[0].exact);
}

// As for the equilibrium; here samples are independent, so the variance is 1 but for the skewness.
TEST(ConditionalMeanFreeTime, ErrorsAreHonestOverManySeeds) {
  Moments z;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    z.Add(*RunPoint(SpecOfReturns(0.6, 0.125, 5000, seed)).estimates[0].ZScore());
  }
  EXPECT_NEAR(z.mean, 0, 4 * 0.071);
  EXPECT_NEAR(*z.Variance(), 1, 4 * 0.1);
}

// With the fewest long returns that get an error, 50 to 60, skewness moves the z-scores: their
// variance is some 1.2. Windows of 4 errors of 200 seeds: 6e-5 false alarms each.
TEST(ConditionalMeanFreeTime, ErrorsAreHonestWithFewLongReturns) {
  for (const double epsilon : {1e-6, 0.5 - 1e-6}) {
    Moments z;
    for (uint64_t seed = 0; seed < 200; ++seed) {
      const int64_t samples = epsilon < 0.25 ? 900 : 5000;
      const auto score = RunPoint(SpecOfReturns(0.3, epsilon, samples, seed)).estimates[0].ZScore();
      ASSERT_TRUE(score);
      z.Add(*score);
    }
    std::cout << "epsilon " << epsilon << ": mean " << z.mean << "  variance " << *z.Variance()
              << "\n";
    EXPECT_NEAR(z.mean, 0, 4 * 0.08);
    EXPECT_NEAR(*z.Variance(), 1.2, 4 * 0.12);
  }
}

}  // namespace
}  // namespace ballpiston
