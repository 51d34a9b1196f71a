#include "core/experiment/point_experiment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace ballpiston {
namespace {

constexpr double kPaperRho = 0.529561127988977;

std::vector<EnsembleSpec> OneOfEach() {
  std::vector<EnsembleSpec> specs = {
      {.experiment = Experiment::kEquilibrium,
       .grid = {.rho = {kPaperRho}, .delta = {0.2, 0.3}},
       .target = {.collisions = 1000}},
      {.experiment = Experiment::kConditionalMeanFreeTime,
       .grid = {.rho = {kPaperRho}, .delta = {0.2, 0.3}, .epsilon = {0.125}},
       .target = {.samples = 1000}},
      {.experiment = Experiment::kFirstHit,
       .grid = {.rho = {kPaperRho}, .delta = {0.2, 0.3}, .epsilon = {0.125}, .exponent = {5}},
       .target = {.samples = 1000}}};
  for (EnsembleSpec& spec : specs) spec.seed = 42;
  for (size_t i = 0; i < 3; ++i) {
    specs.push_back(specs[i]);
    specs.back().model = Model::kBilliard;
  }
  return specs;
}

BlockResult RunAll(const PointExperiment& point) {
  BlockResult merged;
  uint64_t block = 0;
  do {
    merged.Merge(*point.RunBlock(block, {}));
  } while (!point.TargetReached(++block, merged));
  return merged;
}

TEST(PointExperiment, BlocksAreAPureFunctionOfTheirIndex) {
  for (const EnsembleSpec& spec : OneOfEach()) {
    const auto first = PointExperiment::Create(spec, 0), second = PointExperiment::Create(spec, 0);
    const BlockResult later = *first->RunBlock(7, {});
    EXPECT_NE(*first->RunBlock(0, {}), later);
    EXPECT_EQ(*first->RunBlock(7, {}), later);
    EXPECT_EQ(*second->RunBlock(7, {}), later);
  }
}

TEST(PointExperiment, ResultDoesNotDependOnTheRestOfTheGrid) {
  for (EnsembleSpec spec : OneOfEach()) {
    const BlockResult in_grid = RunAll(*PointExperiment::Create(spec, 1));
    EXPECT_NE(in_grid, RunAll(*PointExperiment::Create(spec, 0)));
    spec.grid.delta = {0.3};
    EXPECT_EQ(RunAll(*PointExperiment::Create(spec, 0)), in_grid);
  }
}

TEST(PointExperiment, SeedDecidesTheNumbers) {
  for (EnsembleSpec spec : OneOfEach()) {
    const BlockResult before = RunAll(*PointExperiment::Create(spec, 0));
    spec.seed = 43;
    EXPECT_NE(RunAll(*PointExperiment::Create(spec, 0)), before);
  }
}

TEST(PointExperiment, ComputesWhatTheTargetAsksFor) {
  for (const EnsembleSpec& spec : OneOfEach()) {
    const auto point = PointExperiment::Create(spec, 0);
    const PointSummary summary = point->Summarize(RunAll(*point));
    EXPECT_EQ(summary.samples, 1000u);
    EXPECT_EQ(summary.health.escapes, 0u);
    EXPECT_LT(summary.health.max_energy_error, 1e-14);
    EXPECT_EQ(point->answer().model, spec.model == Model::kAuto ? Model::kBilliard : spec.model);
    for (const Estimate& estimate : summary.estimates) {
      EXPECT_TRUE(std::isfinite(estimate.value)) << estimate.name;
      ASSERT_TRUE(estimate.standard_error) << estimate.name;
    }
  }
}

TEST(PointExperiment, OneSampleIsEnoughForAnAnswerWithoutErrors) {
  for (EnsembleSpec spec : OneOfEach()) {
    (spec.target.samples ? spec.target.samples : spec.target.collisions) = 1;
    const auto point = PointExperiment::Create(spec, 0);
    const PointSummary summary = point->Summarize(RunAll(*point));
    EXPECT_EQ(summary.samples, 1u);
    EXPECT_FALSE(summary.estimates.front().standard_error);
    EXPECT_FALSE(summary.estimates.front().ZScore());
  }
}

TEST(PointExperiment, ToleranceEndsThePointAtItsFirstBlockWithinIt) {
  for (EnsembleSpec spec : OneOfEach()) {
    spec.target = {.tolerance = 0.02};
    const auto point = PointExperiment::Create(spec, 0);
    BlockResult merged;
    uint64_t blocks = 0;
    double before_last = 1;
    while (!point->TargetReached(blocks, merged)) {
      if (blocks > kMinBlocks) {
        const Estimate estimate = point->Summarize(merged).estimates.front();
        before_last = *estimate.standard_error / estimate.value;
      }
      merged.Merge(*point->RunBlock(blocks++, {}));
    }
    const Estimate estimate = point->Summarize(merged).estimates.front();
    EXPECT_LE(*estimate.standard_error / estimate.value, 0.02);
    EXPECT_GT(before_last, 0.02);
    EXPECT_GE(blocks, kMinBlocks);
  }
}

TEST(PointExperiment, StopEndsABlockThatWouldTakeForEver) {
  // Ball and piston meet once in 1e13 time units here: no block of it could end.
  EnsembleSpec spec = OneOfEach()[1];
  spec.grid.delta = {1e-7};
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(PointExperiment::Create(spec, 0)->RunBlock(0, stop.get_token()));
}

TEST(PointExperiment, EnergiesAtBothEndsAreAnswered) {
  for (EnsembleSpec spec : OneOfEach()) {
    if (spec.grid.epsilon.empty()) continue;
    for (const double epsilon : {0.0, 1e-300, 0.25, 0.5 - 0x1p-54, 0.5}) {
      spec.grid.epsilon = {epsilon};
      const auto point = PointExperiment::Create(spec, 0);
      const PointSummary summary = point->Summarize(RunAll(*point));
      EXPECT_EQ(summary.samples, 1000u) << epsilon;
      EXPECT_TRUE(std::isfinite(summary.estimates.front().value)) << epsilon;
    }
  }
}

}  // namespace
}  // namespace ballpiston
