// Return times at fixed energies: their errors, and the cases without an error.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "core/billiard/single_precision.h"
#include "core/geometry/pair_geometry.h"
#include "core/statistics/moments.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/run_point.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

EnsembleSpec SpecOfReturns(double share, double epsilon, int64_t samples, uint64_t seed) {
  return SpecOf(&kConditionalMeanFreeTime, PaperPoint(share * PairDeltaBound(kPaperRho), epsilon),
                {.samples = samples}, Model::kBilliard, seed);
}

// For a resting piston the variance is infinite; its integral diverges only logarithmically. So the
// mean of 1e5 samples is within some percent of the mean over the visited volume, and far from the
// limit of slow pistons, which is 14 times as large.
TEST(ConditionalMeanFreeTime, OfARestingPistonHasTheCorrectMeanWithoutAnError) {
  const PointSummary summary = RunPoint(SpecOfReturns(0.2, 0, 100'000, 4));
  ASSERT_EQ(summary.estimates.size(), 1u);
  EXPECT_FALSE(summary.estimates[0].standard_error);
  EXPECT_NEAR(summary.estimates[0].value / *summary.estimates[0].exact, 1, 0.1);
}

// A piston so slow that its round trips, which dominate the mean, are rarely in the sample: 10,000
// returns contain a round trip for half of the seeds, 500 returns for 4 % of the seeds.
TEST(ConditionalMeanFreeTime, GivesNoErrorIfLongReturnsAreTooRare) {
  const PointSummary summary = RunPoint(SpecOfReturns(0.3, 1e-12, 500, 5));
  EXPECT_FALSE(summary.estimates[0].standard_error);
  EXPECT_LT(summary.estimates[0].value, 0.5 * *summary.estimates[0].exact);
}

// The tolerance is judged at doubling numbers of samples. This rarely stops too early by chance, so
// the stated error stays valid. Of 10,000 seeds 69.6 % were within one stated error and 95.3 %
// within two. With 500 seeds the standard errors of these shares are 2.1 % and 0.95 %. The nightly
// test has 2,000 seeds and half these errors. The windows are four errors wide on either side:
// 1.3e-4 false alarms in all. If the stated error were 20 % too small, 57.6 % would be within one
// and 89.0 % within two; if it were 10 % too small, 63.2 % and 92.8 %.
TEST(ConditionalMeanFreeTime, ErrorsAreValidWhenAToleranceStops) {
  const uint64_t seeds = IsNightly() ? 2000 : 500;
  double within_one = 0, within_two = 0;
  for (uint64_t seed = 0; seed < seeds; ++seed) {
    EnsembleSpec spec = SpecOf(&kConditionalMeanFreeTime, PaperPoint(0.05, 0.25),
                               {.tolerance = 0.02}, Model::kBilliard, seed);
    const double z = std::fabs(*RunPoint(spec).estimates[0].ZScore());
    within_one += z <= 1;
    within_two += z <= 2;
  }
  const auto count = static_cast<double>(seeds);
  std::cout << "within one error " << within_one / count << ", two " << within_two / count << "\n";
  EXPECT_NEAR(within_one / count, 0.6827, 4 * std::sqrt(0.6827 * 0.3173 / count));
  EXPECT_NEAR(within_two / count, 0.9545, 4 * std::sqrt(0.9545 * 0.0455 / count));
}

// As for the equilibrium; here samples are independent, so the variance is 1 but for the skewness.
TEST(ConditionalMeanFreeTime, ErrorsAreValidOverManySeeds) {
  Moments z;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    z.Add(*RunPoint(SpecOfReturns(0.6, 0.125, 5000, seed)).estimates[0].ZScore());
  }
  EXPECT_NEAR(z.mean, 0, 4 * 0.071);
  EXPECT_NEAR(*z.Variance(), 1, 4 * 0.1);
}

// With the fewest long returns that permit an error, 50 to 60, skewness changes the z-scores: their
// variance is about 1.2. Windows of 4 errors of 200 seeds: 6e-5 false alarms each.
TEST(ConditionalMeanFreeTime, ErrorsAreValidWithFewLongReturns) {
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

// Narrow tips, wide tips, and a cell so small that rounding matters most. The windows are the
// stated error plus 4 standard errors: 6e-5 false alarms each. Standard errors are 0.1 to 0.2 %,
// nightly 0.07 to 0.14 %.
TEST(ConditionalMeanFreeTime, SinglePrecisionIsWithinItsStatedError) {
  for (const double rho : {0.501, 0.65, kSingleDomain.max_rho}) {
    const PointParameters point = {{kRho, rho}, {kDelta, PairDeltaBound(rho)}, {kEpsilon, 0.45}};
    EnsembleSpec spec = SpecOf(&kConditionalMeanFreeTime, point,
                               {.samples = IsNightly() ? 1'000'000 : 500'000}, Model::kBilliard, 6);
    spec.precision = Precision::kSingle;
    ASSERT_TRUE(Violations(spec).empty());
    const PointSummary summary = RunPoint(spec);
    const Estimate& time = summary.estimates[0];
    const double off = time.value / *time.exact - 1, error = *time.standard_error / *time.exact;
    std::cout << "rho " << rho << ": " << off << " +- " << error << "\n";
    EXPECT_LT(std::fabs(off), kSinglePrecisionError + 4 * error);
    EXPECT_EQ(summary.health.escapes, 0u);
  }
}

}  // namespace
}  // namespace ballpiston
