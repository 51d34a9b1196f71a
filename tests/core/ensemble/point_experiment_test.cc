// What holds for every experiment by every model that samples, and for the answers without samples.
#include "core/ensemble/point_experiment.h"

#include "core/ensemble/random_stream.h"
#include "core/experiment/all_experiments.h"
#include "tests/core/asked.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

// One specification of each experiment by the billiard in lanes (AUTO chooses it here), then by the
// reference and by the jump process. Each has two values of delta.
std::vector<EnsembleSpec> OneOfEach() {
  std::vector<EnsembleSpec> specs;
  for (const Model model : {Model::kAuto, Model::kBilliardReference, Model::kMarkov}) {
    for (const char* question :
         {"equilibrium delta=0.2,0.3 collisions=2000",
          "conditional-mean-free-time delta=0.2,0.3 samples=1000",
          "first-hit delta=0.2,0.3 exponent=5 samples=1000",
          "energy-relaxation delta=0.2,0.3 samples=1000",
          "energy-relaxation delta=0.2,0.3 epsilon=0.01 samples=1000",
          "markov-property delta=0.2,0.3 collisions=2000", "lyapunov delta=0.2,0.3 collisions=3200",
          "gas-equilibrium delta=0.2,0.15 samples=70", "gas-conduction delta=0.2,0.15 samples=70",
          "gas-lyapunov delta=0.2,0.15 samples=70"}) {
      EnsembleSpec spec = Asked(question);
      if (!spec.experiment->IsAnsweredBy(model)) continue;
      spec.model = model;
      spec.seed = 42;
      specs.push_back(spec);
    }
  }
  return specs;
}

BlockResult Folded(const EnsembleSpec& spec, size_t index = 0) {
  return FoldPoint(*PointExperiment::Create(spec, index));
}

class EachExperiment : public testing::TestWithParam<EnsembleSpec> {
 protected:
  void SetUp() override { ASSERT_TRUE(Violations(spec_).empty()); }
  bool IsBy(Model model) const { return spec_.model == model; }
  bool Is(const ExperimentKind& experiment) const { return spec_.experiment == &experiment; }

  EnsembleSpec spec_ = GetParam();
  std::unique_ptr<const PointExperiment> point_ = PointExperiment::Create(spec_, 0);
};

INSTANTIATE_TEST_SUITE_P(, EachExperiment, testing::ValuesIn(OneOfEach()), [](const auto& test) {
  std::string name = absl::StrCat(test.param.experiment->name, "_by_", Name(test.param.model));
  if (!test.param.grid[kEpsilon].empty()) name += "_from_an_energy";
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST_P(EachExperiment, BlocksAreAPureFunctionOfTheirIndexAndSeed) {
  const auto second = PointExperiment::Create(spec_, 0);
  const Block early = {.samples = 64}, late = {.chunk = 1, .first = 128, .samples = 64};
  const BlockResult later = RunBlock(*point_, late);
  EXPECT_NE(RunBlock(*point_, early), later);
  EXPECT_EQ(RunBlock(*point_, late), later);
  EXPECT_EQ(RunBlock(*second, late), later);
  EXPECT_TRUE(later.HasShapeOf(point_->EmptyResult()));
  EXPECT_FALSE(BlockResult().HasShapeOf(point_->EmptyResult()));
  EXPECT_EQ(point_->EmptyResult().samples, 0u);
  spec_.seed = 43;
  EXPECT_NE(RunBlock(*PointExperiment::Create(spec_, 0), late), later);
}

// Walkers walk in groups, and balls of several orbits fly together in lanes. Only sums round in the
// order of the blocks. An orbit in equilibrium ends with its block, and the walks of the Markov
// property are numbered from their block's first sample.
TEST_P(EachExperiment, ASampleDependsOnlyOnItsNumber) {
  if (Is(kEquilibrium) || Is(kLyapunov) || (Is(kMarkovProperty) && IsBy(Model::kMarkov))) return;
  const uint64_t n = IsOfAGas(spec_.experiment) ? 2 : 256;
  const BlockResult together = RunBlock(*point_, {.samples = 3 * n});
  BlockResult parts = RunBlock(*point_, {.samples = n / 2});
  parts.Merge(RunBlock(*point_, {.first = n / 2, .samples = 5 * n / 2}));
  EXPECT_EQ(parts.samples, together.samples);
  EXPECT_EQ(parts.histograms, together.histograms);
  for (size_t i = 0; i < together.moments.size(); ++i) {
    const Moments& all = together.moments[i];
    const double size = std::fabs(all.mean) + std::sqrt(all.Variance().value());
    EXPECT_NEAR(parts.moments[i].mean, all.mean, 1e-12 * size) << i;
  }
  for (size_t i = 0; i < together.batch_means.size(); ++i) {
    const double all = together.batch_means[i].numerator.mean;
    EXPECT_NEAR(parts.batch_means[i].numerator.mean, all, 1e-12 * std::fabs(all)) << i;
  }
}

// The server checks this bound when it reads a checkpoint.
TEST_P(EachExperiment, CountsOfASampleBoundEveryHistogram) {
  const BlockResult block = RunBlock(*point_, {.samples = 64});
  for (const Histogram& histogram : block.histograms) {
    EXPECT_LE(histogram.Total(), block.samples * point_->CountsOfASample());
  }
}

TEST_P(EachExperiment, ResultDoesNotDependOnTheRestOfTheGrid) {
  const BlockResult in_grid = Folded(spec_, 1);
  EXPECT_NE(in_grid, Folded(spec_, 0));
  spec_.grid[kDelta].erase(spec_.grid[kDelta].begin());
  EXPECT_EQ(Folded(spec_), in_grid);
}

TEST_P(EachExperiment, ComputesTheRequestedSamples) {
  const PointSummary summary = point_->Summarize(FoldPoint(*point_));
  // Where samples continue each other, the same number of each trajectory.
  const uint64_t asked = SamplesAskedFor(spec_.target, ForecastOf(spec_, point_->parameters()));
  EXPECT_GE(summary.samples, asked);
  EXPECT_TRUE(summary.samples == asked || point_->plan().groups() > 0);
  EXPECT_EQ(summary.health.escapes, 0u);
  EXPECT_LT(summary.health.max_energy_error, IsOfAGas(spec_.experiment) ? 1e-13 : 1e-14);
  EXPECT_EQ(point_->answer().model, IsBy(Model::kAuto) ? Model::kBilliard : spec_.model);
  for (const Estimate& estimate : summary.estimates) {
    EXPECT_TRUE(std::isfinite(estimate.value)) << estimate.name;
    const bool is_too_skewed =
        IsBy(Model::kMarkov) && Is(kGasEquilibrium) && estimate.name.starts_with("conductivity");
    EXPECT_TRUE(estimate.standard_error || estimate.noise_floor || is_too_skewed) << estimate.name;
  }
}

TEST(PointExperiment, FewTrajectoriesReachAToleranceWithTheExpectedSamplesOnly) {
  EnsembleSpec spec = Asked("gas-conduction delta=0.2 cells=1x65 samples=64 model=markov");
  BlockResult merged = FoldPoint(*PointExperiment::Create(spec, 0));
  spec.target = {.tolerance = 0.5};  // the error is smaller
  const auto point = PointExperiment::Create(spec, 0);
  const double expected = ScatterOf(spec, PointAt(spec, 0)).SamplesFor(0.5);
  for (const double share : {0.5, 1.0}) {
    merged.samples = point->plan().warm_up() + static_cast<uint64_t>(std::ceil(share * expected));
    EXPECT_EQ(point->ReachesTolerance(merged), share == 1);
  }
}

TEST_P(EachExperiment, AToleranceIsReachedWhenTheErrorIsWithinItButNotByFewSamples) {
  if (Is(kMarkovProperty)) return;  // does not accept a tolerance
  const BlockResult merged = FoldPoint(*point_);
  const Estimate estimate = point_->FirstEstimate(merged);
  const double error = *estimate.standard_error / std::fabs(estimate.value);
  for (const double share : {1.01, 0.99}) {
    spec_.target = {.tolerance = share * error};
    const auto point = PointExperiment::Create(spec_, 0);
    EXPECT_EQ(point->ReachesTolerance(merged), share > 1);
    BlockResult few = merged;
    const Scatter scatter = ScatterOf(spec_, point->parameters());
    few.samples =
        point->plan().warm_up() + static_cast<uint64_t>(scatter.SamplesFor(share * error) / 4);
    EXPECT_FALSE(point->ReachesTolerance(few));
  }
}

TEST_P(EachExperiment, TheNamedEstimateIsTheFirst) {
  const std::vector<AimedEstimate> aims(spec_.experiment->aims.begin(),
                                        spec_.experiment->aims.end());
  EXPECT_EQ(point_->FirstEstimate(point_->EmptyResult()).name, aims.front().name);
  for (const AimedEstimate& aim : aims) {
    for (const Model model : aim.models) {
      spec_.model = model;
      spec_.target.estimate = std::string(aim.name);
      ASSERT_TRUE(Violations(spec_).empty());
      const auto point = PointExperiment::Create(spec_, 0);
      const BlockResult block =
          TakesSamples(model) ? RunBlock(*point, point->plan().BlockAt(0, 0)) : BlockResult();
      EXPECT_EQ(point->FirstEstimate(block).name, aim.name);
      EXPECT_EQ(point->Summarize(block).estimates.front().name, aim.name);
    }
  }
}

// The estimates have the names of the sampled ones, from which they differ by a z-score of 5 at
// most.
TEST_P(EachExperiment, ClosedFormsAnswerWithoutABlock) {
  if (!AimOf(spec_).HasClosedForm()) return;
  const PointSummary measured = RunPoint(spec_);
  spec_.model = Model::kClosedForm;
  for (const Target& target : {Target{}, Target{.tolerance = 1e-12}, spec_.target}) {
    spec_.target = target;
    ASSERT_TRUE(Violations(spec_).empty());
    const auto point = PointExperiment::Create(spec_, 0);
    EXPECT_EQ(point->plan().samples(), 0u);
    EXPECT_TRUE(PointFold(*point).finished());
    const PointSummary summary = point->Summarize({});
    EXPECT_EQ(summary.samples, 0u);
    EXPECT_EQ(summary.estimates.front().name, point->FirstEstimate({}).name);
    for (size_t i = 0; i < summary.estimates.size(); ++i) {
      const Estimate &exact = summary.estimates[i], &sampled = measured.estimates[i];
      EXPECT_EQ(exact.name, sampled.name);
      EXPECT_EQ(exact.value, exact.exact);
      EXPECT_EQ(exact.value, sampled.exact);
      EXPECT_LT(std::fabs(*sampled.ZScore()), 5) << exact.name;
      const bool is_given = exact.name.starts_with("temperature");
      EXPECT_EQ(*exact.standard_error > 0, !is_given) << exact.name;
      EXPECT_LT(*exact.standard_error, 1e-11 * exact.value);
    }
  }
}

// The numbers are the same as if the specification had named the model.
TEST(PointExperiment, AnswerDecidesTheModel) {
  EnsembleSpec spec = SpecOf(&kEnergyRelaxation, PaperPoint(0.2), {.samples = 1000});
  const auto spectrum = PointExperiment::Create(
      spec, 0, {.model = Model::kSpectrum, .reason = "chosen", .model_error = 0.01});
  EXPECT_EQ(spectrum->answer().model, Model::kSpectrum);
  EXPECT_EQ(spectrum->answer().reason, "chosen");
  EXPECT_EQ(spectrum->answer().model_error, 0.01);
  EXPECT_EQ(spectrum->plan().samples(), 0u);
  const auto walks = PointExperiment::Create(spec, 0, {.model = Model::kMarkov});
  spec.model = Model::kMarkov;
  EXPECT_EQ(FoldPoint(*walks), Folded(spec));
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

// ---- random_stream.h ----

TEST(PointStream, TheJumpProcessHasItsOwnRandomNumbers) {
  const auto stream = [](Model model) {
    return PointStream({.experiment = &kEnergyRelaxation, .model = model}, PaperPoint(0.1));
  };
  EXPECT_NE(stream(Model::kMarkov), stream(Model::kBilliard));
  EXPECT_EQ(stream(Model::kBilliardReference), stream(Model::kBilliard));
}

}  // namespace
}  // namespace ballpiston
