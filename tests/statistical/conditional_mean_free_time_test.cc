// Return times at fixed energies against the closed form, which is exact at every delta.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "core/geometry/pair_geometry.h"
#include "core/statistics/moments.h"
#include "tests/statistical/run_point.h"

namespace ballpiston {
namespace {

EnsembleSpec SpecOf(double rho, double share, double epsilon, int64_t samples, uint64_t seed) {
  EnsembleSpec spec = {
      .experiment = Experiment::kConditionalMeanFreeTime,
      .grid = {.rho = {rho}, .delta = {share * PairDeltaBound(rho)}, .epsilon = {epsilon}},
      .target = {.samples = samples}};
  spec.seed = seed;
  return spec;
}

// Energies from one end to the other, over geometries from cusps to a nearly vanished cell: 54
// comparisons at 4 standard errors, 0.3 percent false alarms in all. At epsilon = 1/2 the ball
// rests, and the mean is that of the volume which is visited.
TEST(ConditionalMeanFreeTime, IsTheClosedFormAtEveryEnergyAndGeometry) {
  for (const double rho : {0.501, 0.529561127988977, 0.7}) {
    for (const double share : {1.0, 0.5, 0.2}) {
      for (const double epsilon : {1.0 / 3200, 0.125, 0.25, 0.375, 0.5 - 1.0 / 3200, 0.5}) {
        const Estimate mean = RunPoint(SpecOf(rho, share, epsilon, 10'000, 4)).estimates[0];
        ASSERT_TRUE(mean.ZScore());
        EXPECT_LT(std::fabs(*mean.ZScore()), 4)
            << "rho " << rho << " share " << share << " epsilon " << epsilon << ": " << mean.value
            << " against " << *mean.exact;
      }
    }
  }
}

// A resting piston: the variance is infinite, but only just (its integral grows as the logarithm of
// the sample's size), so the mean of 1e5 samples is within some percent of that of the volume which
// is visited, and far from the limit of slow pistons, 14 times as large.
TEST(ConditionalMeanFreeTime, OfARestingPistonHasNoErrorButTheRightMean) {
  const PointSummary summary = RunPoint(SpecOf(0.529561127988977, 0.2, 0, 100'000, 4));
  ASSERT_EQ(summary.estimates.size(), 1u);
  EXPECT_FALSE(summary.estimates[0].standard_error);
  EXPECT_NEAR(summary.estimates[0].value / *summary.estimates[0].exact, 1, 0.1);
}

// A piston so slow that its round trips, which carry the mean, are not in the sample.
TEST(ConditionalMeanFreeTime, GivesNoErrorWhereLongReturnsAreNotSeen) {
  const PointSummary summary = RunPoint(SpecOf(0.529561127988977, 0.3, 1e-12, 10'000, 4));
  EXPECT_FALSE(summary.estimates[0].standard_error);
  EXPECT_LT(summary.estimates[0].value, 0.5 * *summary.estimates[0].exact);
}

// As for the equilibrium; here samples are independent, so the variance is 1 but for the skewness.
TEST(ConditionalMeanFreeTime, ErrorsAreHonestOverManySeeds) {
  Moments z;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    z.Add(*RunPoint(SpecOf(0.529561127988977, 0.6, 0.125, 5000, seed)).estimates[0].ZScore());
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
      const auto score =
          RunPoint(SpecOf(0.529561127988977, 0.3, epsilon, samples, seed)).estimates[0].ZScore();
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
