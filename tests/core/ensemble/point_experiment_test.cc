#include "core/ensemble/point_experiment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/mean_free_time.h"
#include "core/ensemble/experiment_kind.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_geometry.h"
#include "core/geometry/pair_geometry.h"
#include "core/markov/relaxation_spectrum.h"
#include "tests/core/geometries.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/run_point.h"
#include "tests/core/stopped.h"

namespace ballpiston {
namespace {

// One specification of each experiment by the billiard in lanes (AUTO chooses it here), then by the
// reference and by the jump process.
std::vector<EnsembleSpec> OneOfEach() {
  const PointParameters pair = PaperPoint(0.2);
  const Target samples = {.samples = 1000}, collisions = {.collisions = 2000};
  const Target gases = {.samples = 70};
  std::vector<EnsembleSpec> specs;
  for (const Model model : {Model::kAuto, Model::kBilliardReference, Model::kMarkov}) {
    for (const auto& [experiment, point, target] :
         {std::tuple<const ExperimentKind*, PointParameters, Target>(&kEquilibrium, pair,
                                                                     collisions),
          {&kConditionalMeanFreeTime, PaperPoint(0.2, 0.125), samples},
          {&kFirstHit, PaperPoint(0.2, 0.125, 5), samples},
          {&kEnergyRelaxation, pair, samples},
          {&kEnergyRelaxation, PaperPoint(0.2, 0.01), samples},
          {&kMarkovProperty, pair, collisions},
          {&kGasEquilibrium, PaperGas(&kGasEquilibrium, 0.2), gases},
          {&kGasConduction, PaperGas(&kGasConduction, 0.2), gases}}) {
      if (!experiment->IsAnsweredBy(model)) continue;
      specs.push_back(SpecOf(experiment, point, target, model, 42));
      specs.back().grid[kDelta] = {0.2, IsOfAGas(experiment) ? 0.15 : 0.3};
      EXPECT_TRUE(Violations(specs.back()).empty());
    }
  }
  return specs;
}

EnsembleSpec OneOf(const ExperimentKind* experiment) {
  for (const EnsembleSpec& spec : OneOfEach()) {
    if (spec.experiment == experiment) return spec;
  }
  return {};
}

std::string Described(const EnsembleSpec& spec) {
  return absl::StrCat(spec.experiment->name, " by ", Name(spec.model));
}

TEST(PointExperiment, BlocksAreAPureFunctionOfTheirIndex) {
  for (const EnsembleSpec& spec : OneOfEach()) {
    SCOPED_TRACE(Described(spec));
    const auto first = PointExperiment::Create(spec, 0), second = PointExperiment::Create(spec, 0);
    const Block early = {.samples = 64}, late = {.chunk = 1, .first = 128, .samples = 64};
    const BlockResult later = *RunBlock(*first, late);
    EXPECT_NE(*RunBlock(*first, early), later);
    EXPECT_EQ(*RunBlock(*first, late), later);
    EXPECT_EQ(*RunBlock(*second, late), later);
  }
}

TEST(BlockResult, EveryBlockHasTheShapeOfTheEmptyOne) {
  for (const EnsembleSpec& spec : OneOfEach()) {
    const auto point = PointExperiment::Create(spec, 0);
    const BlockResult empty = point->EmptyResult();
    EXPECT_TRUE(RunBlock(*point, point->plan().BlockAt(0, 0))->HasShapeOf(empty))
        << Described(spec);
    EXPECT_EQ(empty.samples, 0u);
    EXPECT_FALSE(BlockResult().HasShapeOf(empty)) << Described(spec);
  }
}

TEST(PointExperiment, ResultDoesNotDependOnTheRestOfTheGrid) {
  for (EnsembleSpec spec : OneOfEach()) {
    SCOPED_TRACE(Described(spec));
    const BlockResult in_grid = *FoldPoint(*PointExperiment::Create(spec, 1));
    EXPECT_NE(in_grid, *FoldPoint(*PointExperiment::Create(spec, 0)));
    spec.grid[kDelta].erase(spec.grid[kDelta].begin());
    EXPECT_EQ(*FoldPoint(*PointExperiment::Create(spec, 0)), in_grid);
  }
}

TEST(PointExperiment, SeedDecidesTheNumbers) {
  for (EnsembleSpec spec : OneOfEach()) {
    SCOPED_TRACE(Described(spec));
    const BlockResult before = *FoldPoint(*PointExperiment::Create(spec, 0));
    spec.seed = 43;
    EXPECT_NE(*FoldPoint(*PointExperiment::Create(spec, 0)), before);
  }
}

TEST(PointExperiment, ComputesTheRequestedSamples) {
  for (const EnsembleSpec& spec : OneOfEach()) {
    SCOPED_TRACE(Described(spec));
    const auto point = PointExperiment::Create(spec, 0);
    const PointSummary summary = point->Summarize(*FoldPoint(*point));
    // Where samples continue each other, the same number of each trajectory.
    const uint64_t asked = SamplesAskedFor(spec, point->parameters());
    EXPECT_GE(summary.samples, asked);
    if (point->plan().groups() == 0) {
      EXPECT_EQ(summary.samples, asked);
    }
    EXPECT_EQ(summary.health.escapes, 0u);
    EXPECT_LT(summary.health.max_energy_error, IsOfAGas(spec.experiment) ? 1e-13 : 1e-14);
    EXPECT_EQ(point->answer().model, spec.model == Model::kAuto ? Model::kBilliard : spec.model);
    for (const Estimate& estimate : summary.estimates) {
      EXPECT_TRUE(std::isfinite(estimate.value)) << estimate.name;
      const bool is_too_skewed = spec.model == Model::kMarkov &&
                                 estimate.name.starts_with("conductivity") &&
                                 spec.experiment == &kGasEquilibrium;
      EXPECT_TRUE(estimate.standard_error || estimate.noise_floor || is_too_skewed)
          << estimate.name;
    }
  }
}

TEST(PointExperiment, OneSampleIsEnoughForAnAnswerWithoutErrors) {
  for (EnsembleSpec spec : OneOfEach()) {
    SCOPED_TRACE(Described(spec));
    if (spec.experiment->trajectories != nullptr) continue;  // a sample of each trajectory
    (spec.target.samples ? spec.target.samples : spec.target.collisions) = 1;
    const auto point = PointExperiment::Create(spec, 0);
    const PointSummary summary = point->Summarize(*FoldPoint(*point));
    EXPECT_EQ(summary.samples, 1u);
    EXPECT_FALSE(summary.estimates.front().standard_error);
    EXPECT_FALSE(summary.estimates.front().ZScore());
  }
}

TEST(PointExperiment, AToleranceIsReachedWhenTheErrorIsWithinIt) {
  for (EnsembleSpec spec : OneOfEach()) {
    if (spec.experiment == &kMarkovProperty) continue;  // does not accept a tolerance
    SCOPED_TRACE(Described(spec));
    const auto sampled = PointExperiment::Create(spec, 0);
    const BlockResult merged = *FoldPoint(*sampled);
    const Estimate estimate = sampled->FirstEstimate(merged);
    const double error = *estimate.standard_error / std::fabs(estimate.value);
    spec.target = {.tolerance = 1.01 * error};
    EXPECT_TRUE(PointExperiment::Create(spec, 0)->ReachesTolerance(merged));
    spec.target = {.tolerance = 0.99 * error};
    EXPECT_FALSE(PointExperiment::Create(spec, 0)->ReachesTolerance(merged));
  }
}

TEST(PointExperiment, TheNamedEstimateIsTheFirst) {
  for (EnsembleSpec spec : OneOfEach()) {
    for (const AimedEstimate& aim : spec.experiment->aims) {
      for (const Model model : aim.models) {
        spec.model = model;
        spec.target.estimate = std::string(aim.name);
        SCOPED_TRACE(absl::StrCat(Described(spec), ", ", aim.name));
        ASSERT_TRUE(Violations(spec).empty());
        const auto point = PointExperiment::Create(spec, 0);
        const BlockResult block = *RunBlock(*point, point->plan().BlockAt(0, 0));
        EXPECT_EQ(point->FirstEstimate(block).name, aim.name);
        EXPECT_EQ(point->Summarize(block).estimates.front().name, aim.name);
      }
    }
    spec.target.estimate = "";
    const auto point = PointExperiment::Create(spec, 0);
    EXPECT_EQ(point->FirstEstimate(point->EmptyResult()).name, spec.experiment->aims.front().name);
  }
}

// Ball and piston collide once in 1e13 time units here, so only the stop ends a billiard's block.
TEST(PointExperiment, StopEndsABlock) {
  for (EnsembleSpec spec : OneOfEach()) {
    // The jump process takes no longer at a small delta. A short block may end without a look.
    if (spec.experiment != &kEnergyRelaxation && spec.model == Model::kMarkov) continue;
    spec.grid[kDelta] = {1e-7};
    EXPECT_FALSE(RunBlock(*PointExperiment::Create(spec, 0), {.samples = 1}, Stopped()))
        << Described(spec);
  }
}

TEST(PointExperiment, EnergiesAtBothEndsAreAnswered) {
  for (EnsembleSpec spec : OneOfEach()) {
    SCOPED_TRACE(Described(spec));
    if (spec.grid[kEpsilon].empty()) continue;
    for (const double epsilon : {0.0, 1e-300, 0.25, 0.5 - 0x1p-54, 0.5}) {
      spec.grid[kEpsilon] = {epsilon};
      const auto point = PointExperiment::Create(spec, 0);
      const PointSummary summary = point->Summarize(*FoldPoint(*point));
      EXPECT_EQ(summary.samples, 1000u) << epsilon;
      EXPECT_TRUE(std::isfinite(summary.estimates.front().value)) << epsilon;
    }
  }
}

// At the second point of OneOfEach().
double FirstClosedForm(const ExperimentKind* experiment) {
  if (experiment == &kGasEquilibrium) {
    const GasGeometry gas =
        GasGeometry::Create(kPaperRho, 0.15, {.columns = 2}, GasEnds::kPeriodic).value();
    return GasExchangeRate(gas, 2);
  }
  const PairGeometry pair = PaperGeometry(0.3);
  return experiment == &kEquilibrium ? MeanFreeTimesOf(pair).ball_piston
                                     : ConditionalMeanFreeTime(pair, 0.125);
}

TEST(PointExperiment, ClosedFormsAnswerWithoutABlock) {
  for (EnsembleSpec spec : OneOfEach()) {
    if (!AimOf(spec).HasClosedForm()) continue;
    spec.model = Model::kClosedForm;
    for (const Target& target : {Target{}, Target{.tolerance = 1e-12}, spec.target}) {
      spec.target = target;
      ASSERT_TRUE(Violations(spec).empty());
      const auto point = PointExperiment::Create(spec, 1);
      EXPECT_EQ(point->plan().samples(), 0u);
      EXPECT_TRUE(PointFold(*point).finished());
      const PointSummary summary = point->Summarize({});
      EXPECT_EQ(summary.samples, 0u);
      EXPECT_EQ(summary.estimates.front().name, point->FirstEstimate({}).name);
      for (const Estimate& estimate : summary.estimates) {
        EXPECT_EQ(estimate.value, estimate.exact);
        const bool is_given = estimate.name.starts_with("temperature");
        EXPECT_EQ(*estimate.standard_error > 0, !is_given) << estimate.name;
        EXPECT_LT(*estimate.standard_error, 1e-11 * estimate.value);
      }
      EXPECT_EQ(summary.estimates.front().value, FirstClosedForm(spec.experiment));
    }
  }
}

// Closed form, sampling and their names belong together: a z-score of 5 for 1000 samples.
TEST(PointExperiment, ClosedFormsAreNamedAsTheEstimatesTheyStandFor) {
  for (EnsembleSpec spec : OneOfEach()) {
    if (!AimOf(spec).HasClosedForm()) continue;
    spec.model = Model::kBilliard;
    const auto sampled = PointExperiment::Create(spec, 0);
    spec.model = Model::kClosedForm;
    const PointSummary exact = PointExperiment::Create(spec, 0)->Summarize({});
    const PointSummary measured = sampled->Summarize(*FoldPoint(*sampled));
    for (size_t i = 0; i < exact.estimates.size(); ++i) {
      EXPECT_EQ(exact.estimates[i].name, measured.estimates[i].name);
      EXPECT_EQ(exact.estimates[i].value, measured.estimates[i].exact);
      EXPECT_LT(std::fabs(*measured.estimates[i].ZScore()), 5);
    }
  }
}

TEST(PointExperiment, SpectrumAnswersWithoutABlock) {
  const double unit = MeanFreeTimesOf(PaperGeometry(0.2)).ball_piston / 4;
  EnsembleSpec spec = OneOf(&kEnergyRelaxation);
  spec.model = Model::kSpectrum;
  const auto point = PointExperiment::Create(spec, 0);
  EXPECT_EQ(point->plan().samples(), 0u);
  const PointSummary summary = point->Summarize({});
  ASSERT_GE(summary.estimates.size(), 2u);
  EXPECT_EQ(summary.estimates[0].name, "relaxation_time");
  EXPECT_NEAR(summary.estimates[0].value / unit, 2.165550673728, 1e-11);
  EXPECT_LT(*summary.estimates[0].standard_error / unit, 1e-10);
  EXPECT_EQ(summary.estimates[1].name, "spectral_gap");
  EXPECT_EQ(summary.estimates[1].value, RelaxationSpectrum::Get().Gap().value);
  ASSERT_EQ(summary.curves.size(), 1u);
  EXPECT_EQ(summary.curves[0].name, "energy_autocorrelation");
  EXPECT_NEAR(summary.curves[0].points.front().value, 1, 1e-13);
}

TEST(PointExperiment, AnswerDecidesTheModel) {
  EnsembleSpec spec = OneOf(&kEnergyRelaxation);
  const Answer answer = {.model = Model::kSpectrum, .reason = "chosen", .model_error = 0.01};
  const auto point = PointExperiment::Create(spec, 0, answer);
  EXPECT_EQ(point->answer().model, Model::kSpectrum);
  EXPECT_EQ(point->answer().reason, "chosen");
  EXPECT_EQ(point->answer().model_error, 0.01);
  EXPECT_EQ(point->plan().samples(), 0u);
  // The numbers are the same as if the specification had named the model.
  const auto chosen = PointExperiment::Create(spec, 0, {.model = Model::kMarkov});
  spec.model = Model::kMarkov;
  EXPECT_EQ(*FoldPoint(*chosen), *FoldPoint(*PointExperiment::Create(spec, 0)));
}

// A correlation needs two exchanges of one orbit, also if collisions are very rare.
TEST(PointExperiment, BlocksHoldWholeOrbitsOfExchanges) {
  for (const Model model : {Model::kBilliard, Model::kBilliardReference, Model::kMarkov}) {
    for (const double delta : {0.2, 1e-3, 1e-6}) {
      const EnsembleSpec spec =
          SpecOf(&kMarkovProperty, PaperPoint(delta), {.collisions = 1'000'000}, model);
      EXPECT_GE(PointExperiment::Create(spec, 0)->plan().BlockAt(0, 0).samples, 32u) << delta;
    }
  }
}

TEST(ExperimentKind, RowsAreComplete) {
  std::set<absl::string_view> names;
  std::set<uint64_t> numbers;
  for (const ExperimentKind* kind : AllExperiments()) {
    EXPECT_TRUE(kind->create && kind->check_grid && kind->work && kind->collisions &&
                !kind->aims.empty())
        << kind->name;
    EXPECT_FALSE(kind->parameters.empty() || kind->models.empty()) << kind->name;
    for (const AimedEstimate& aim : kind->aims) {
      EXPECT_TRUE(aim.error && !aim.name.empty() && !aim.models.empty()) << kind->name;
    }
    EXPECT_EQ(FindExperiment(kind->number), kind);
    names.insert(kind->name);
    numbers.insert(kind->number);
  }
  EXPECT_EQ(names.size(), AllExperiments().size());
  EXPECT_EQ(numbers.size(), AllExperiments().size());
}

TEST(PointExperiment, CollisionsAreSharedByTheOrbitsThatTakeThem) {
  const PointParameters point = PaperPoint(0.2);  // orbits of 40 collisions
  const auto samples = [&](const Target& target) {
    return SamplesAskedFor(SpecOf(&kEnergyRelaxation, point, target), point);
  };
  EXPECT_EQ(samples({.collisions = 1000}), 25u);
  EXPECT_EQ(samples({.collisions = 1001}), 26u);
  EXPECT_EQ(samples({.collisions = 1}), 1u);
  EXPECT_EQ(samples({.samples = 1000}), 1000u);
  EXPECT_EQ(samples({}), static_cast<uint64_t>(kDefaultSamples));
  EXPECT_EQ(samples({.tolerance = 0.01}), static_cast<uint64_t>(kMaxSamples));
}

}  // namespace
}  // namespace ballpiston
