// The standard errors of mean free times in equilibrium agree with the scatter of the estimates.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>

#include "core/geometry/pair_geometry.h"
#include "core/statistics/moments.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

EnsembleSpec SpecOfCollisions(double share, int64_t collisions, uint64_t seed) {
  return SpecOf(&kEquilibrium, PaperPoint(share * PairDeltaBound(kPaperRho)),
                {.collisions = collisions}, Model::kBilliard, seed);
}

std::array<Moments, 3> ZScoresOfSeeds(double share, int64_t collisions) {
  std::array<Moments, 3> z;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const PointSummary summary = RunPoint(SpecOfCollisions(share, collisions, seed));
    for (size_t i = 0; i < z.size(); ++i) z[i].Add(*summary.estimates[i].ZScore());
  }
  return z;
}

// z-scores of 200 seeds: their variance has standard error sqrt(2/200) = 0.1, their mean 0.07. Were
// the errors wrong by a factor 1.2 the variance would be 1.44. With 64 to 128 batches the ratio has
// heavier tails than the normal law (1.03 expected). Windows of 4 errors: 6e-5 false alarms each.
TEST(Equilibrium, ErrorsAreValidOverManySeeds) {
  const std::array<Moments, 3> z = ZScoresOfSeeds(0.6, 5000);
  for (const Moments& moments : z) {
    std::cout << "mean " << moments.mean << "  variance " << *moments.Variance() << "\n";
    EXPECT_NEAR(moments.mean, 0, 4 * 0.071);
    EXPECT_NEAR(*moments.Variance(), 1.03, 4 * 0.1);
  }
}

// The fewest collisions that get an error; the ratio's skewness costs a little.
TEST(Equilibrium, ErrorsAreValidWithTheFewestCollisions) {
  for (const Moments& moments : ZScoresOfSeeds(0.3, 500)) {
    std::cout << "mean " << moments.mean << "  variance " << *moments.Variance() << "\n";
    EXPECT_NEAR(moments.mean, 0, 4 * 0.075);
    EXPECT_NEAR(*moments.Variance(), 1.1, 4 * 0.11);
  }
  const PointSummary fewer = RunPoint(SpecOfCollisions(0.3, 499, 1));
  for (const Estimate& estimate : fewer.estimates) EXPECT_FALSE(estimate.standard_error);
}

}  // namespace
}  // namespace ballpiston
