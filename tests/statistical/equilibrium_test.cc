// Mean free times in equilibrium against the closed forms, and whether their errors are honest.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iomanip>
#include <iostream>

#include "core/geometry/pair_geometry.h"
#include "core/statistics/moments.h"
#include "tests/statistical/run_point.h"

namespace ballpiston {
namespace {

struct Case {
  double rho;
  double share;  // of the bound on delta
};

EnsembleSpec SpecOf(const Case& c, int64_t collisions, uint64_t seed) {
  EnsembleSpec spec = {.experiment = Experiment::kEquilibrium,
                       .grid = {.rho = {c.rho}, .delta = {c.share * PairDeltaBound(c.rho)}},
                       .target = {.collisions = collisions}};
  spec.seed = seed;
  return spec;
}

class EquilibriumGeometry : public testing::TestWithParam<Case> {};

// 30 comparisons at 4 standard errors: 0.2 percent false alarms in all.
TEST_P(EquilibriumGeometry, MeanFreeTimesAreTheClosedForms) {
  const PointSummary summary = RunPoint(SpecOf(GetParam(), 100'000, 3));
  EXPECT_EQ(summary.health.escapes, 0u);
  for (const Estimate& estimate : summary.estimates) {
    std::cout << estimate.name << " " << std::setprecision(8) << estimate.value << " exact "
              << *estimate.exact << " z " << std::setprecision(3) << *estimate.ZScore() << "\n";
    EXPECT_LT(std::fabs(*estimate.ZScore()), 4) << estimate.name;
  }
}

INSTANTIATE_TEST_SUITE_P(FromCuspsToVanishingCells, EquilibriumGeometry,
                         testing::Values(Case{0.501, 1}, Case{0.501, 0.3}, Case{0.51, 0.5},
                                         Case{0.529561127988977, 1}, Case{0.529561127988977, 0.3},
                                         Case{0.56, 0.7}, Case{0.6, 0.4}, Case{0.65, 0.8},
                                         Case{0.7, 0.5}, Case{0.705, 0.9}));

std::array<Moments, 3> ZScoresOfSeeds(const Case& c, int64_t collisions) {
  std::array<Moments, 3> z;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const PointSummary summary = RunPoint(SpecOf(c, collisions, seed));
    for (size_t i = 0; i < z.size(); ++i) z[i].Add(*summary.estimates[i].ZScore());
  }
  return z;
}

// z-scores of 200 seeds: their variance has standard error sqrt(2/200) = 0.1, their mean 0.07. Were
// the errors wrong by a factor 1.2 the variance would be 1.44. With 64 to 128 batches the ratio has
// heavier tails than the normal law (1.03 expected). Windows of 4 errors: 6e-5 false alarms each.
TEST(Equilibrium, ErrorsAreHonestOverManySeeds) {
  const std::array<Moments, 3> z = ZScoresOfSeeds({0.529561127988977, 0.6}, 5000);
  for (const Moments& moments : z) {
    std::cout << "mean " << moments.mean << "  variance " << *moments.Variance() << "\n";
    EXPECT_NEAR(moments.mean, 0, 4 * 0.071);
    EXPECT_NEAR(*moments.Variance(), 1.03, 4 * 0.1);
  }
}

// The fewest collisions that get an error; the ratio's skewness costs a little.
TEST(Equilibrium, ErrorsAreHonestFromTheFewestCollisionsOn) {
  for (const Moments& moments : ZScoresOfSeeds({0.529561127988977, 0.3}, 500)) {
    std::cout << "mean " << moments.mean << "  variance " << *moments.Variance() << "\n";
    EXPECT_NEAR(moments.mean, 0, 4 * 0.075);
    EXPECT_NEAR(*moments.Variance(), 1.1, 4 * 0.11);
  }
  const PointSummary fewer = RunPoint(SpecOf({0.529561127988977, 0.3}, 499, 1));
  for (const Estimate& estimate : fewer.estimates) EXPECT_FALSE(estimate.standard_error);
}

}  // namespace
}  // namespace ballpiston
