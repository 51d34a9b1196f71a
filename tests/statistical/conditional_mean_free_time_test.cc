// Return times at fixed energies against the closed form, which is exact at every delta.
#include <gtest/gtest.h>

#include <cmath>

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

// All energies with both ends, over geometries from cusps to a nearly vanished cell: 63 comparisons
// at 4 standard errors, 0.4 percent false alarms in all. At the two ends one of the two
// rests, and the mean is that of the volume which is visited.
TEST(ConditionalMeanFreeTime, IsTheClosedFormAtEveryEnergyAndGeometry) {
  for (const double rho : {0.501, 0.529561127988977, 0.7}) {
    for (const double share : {1.0, 0.5, 0.2}) {
      for (const double epsilon : {0.0, 1.0 / 3200, 0.125, 0.25, 0.375, 0.5 - 1.0 / 3200, 0.5}) {
        const PointSummary summary = RunPoint(SpecOf(rho, share, epsilon, 10'000, 4));
        EXPECT_LT(std::fabs(*summary.estimates[0].ZScore()), 4)
            << "rho " << rho << " share " << share << " epsilon " << epsilon << ": "
            << summary.estimates[0].value << " against " << *summary.estimates[0].exact;
      }
    }
  }
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

}  // namespace
}  // namespace ballpiston
