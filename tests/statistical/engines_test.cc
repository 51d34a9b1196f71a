// The billiard in lanes against the closed forms, wherever there are some.
#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/pair_geometry.h"
#include "tests/statistical/run_point.h"

namespace ballpiston {
namespace {

void ExpectCredible(const EnsembleSpec& spec) {
  for (size_t point = 0; point < PointCount(spec); ++point) {
    const PointSummary summary = RunPoint(spec, point);
    EXPECT_EQ(summary.health.escapes, 0u);
    for (const Estimate& estimate : summary.estimates) {
      if (const auto z = estimate.ZScore()) {
        EXPECT_LT(std::fabs(*z), 4.5) << estimate.name << " at point " << point;
      }
    }
  }
}

// 4.5 standard errors: 7e-6 false alarms a comparison, of which there are about 150.
TEST(LaneEngine, GivesTheExactMeansFromCuspsToVanishingCells) {
  for (const double rho : {0.501, 0.51, 0.529561127988977, 0.6, 0.65, 0.7, 0.705}) {
    const double bound = PairDeltaBound(rho);
    EnsembleSpec spec = {.experiment = Experiment::kEquilibrium,
                         .grid = {.rho = {rho}, .delta = {bound, 0.5 * bound, 0.1 * bound}},
                         .target = {.collisions = 200'000},
                         .seed = 9,
                         .model = Model::kBilliard};
    ExpectCredible(spec);
    spec.experiment = Experiment::kConditionalMeanFreeTime;
    spec.grid.epsilon = {1.0 / 3200, 0.125, 0.25, 0.375, 0.5 - 1.0 / 3200, 0.5};
    spec.target = {.samples = 20'000};
    ExpectCredible(spec);
  }
}

// At its noise floor: KL within 4 errors of it at each energy.
TEST(LaneEngine, FirstHitsOfTheInvariantLawSitOnTheNoiseFloor) {
  EnsembleSpec spec = {.experiment = Experiment::kFirstHit,
                       .grid = {.rho = {0.529561127988977},
                                .delta = {0.05},
                                .epsilon = {0.03125, 0.125, 0.25, 0.375, 0.46875},
                                .exponent = {1}},
                       .target = {.samples = 100'000},
                       .seed = 9,
                       .model = Model::kBilliard};
  ExpectCredible(spec);
  for (size_t point = 0; point < PointCount(spec); ++point) {
    const KlDivergence kl = *RunPoint(spec, point).kl_divergence;
    EXPECT_NEAR(kl.value, kl.noise_floor, 4 * std::sqrt(2.0 * (kl.cells - 1)) / (2 * 100'000));
  }
}

}  // namespace
}  // namespace ballpiston
