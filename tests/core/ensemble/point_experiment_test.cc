// What holds for every experiment by every model that samples, and for the answers without samples.
#include "core/ensemble/point_experiment.h"

#include "core/closed_form/mean_free_time.h"
#include "core/ensemble/random_stream.h"
#include "core/experiment/all_experiments.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_geometry.h"
#include "core/markov/relaxation_spectrum.h"
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

EnsembleSpec RelaxationBy(Model model) {
  return SpecOf(&kEnergyRelaxation, PaperPoint(0.2), {.samples = 1000}, model, 42);
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
  PointParameters gas = PaperGas(&kGasConduction, 0.2, {1, 65, true});
  gas.Set(kHot, 1.5);
  gas.Set(kCold, 0.5);
  EnsembleSpec spec = SpecOf(&kGasConduction, gas, {.samples = 64}, Model::kMarkov);
  BlockResult merged = FoldPoint(*PointExperiment::Create(spec, 0));
  spec.target = {.tolerance = 0.5};  // the error is smaller
  const auto point = PointExperiment::Create(spec, 0);
  const double expected = ScatterOf(spec, gas).SamplesFor(0.5);
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

TEST_P(EachExperiment, EnergiesAtBothEndsAreAnswered) {
  if (spec_.grid[kEpsilon].empty()) return;
  for (const double epsilon : {0.0, 1e-300, 0.25, 0.5 - 0x1p-54, 0.5}) {
    spec_.grid[kEpsilon] = {epsilon};
    const PointSummary summary = RunPoint(spec_);
    EXPECT_EQ(summary.samples, 1000u) << epsilon;
    EXPECT_TRUE(std::isfinite(summary.estimates.front().value)) << epsilon;
  }
}

// At the second point of OneOfEach().
double FirstClosedForm(const ExperimentKind* experiment) {
  if (experiment == &kGasEquilibrium) {
    return GasExchangeRate(
        GasGeometry::Create(kPaperRho, 0.15, {.columns = 2}, GasEnds::kPeriodic).value(), 2);
  }
  const PairGeometry pair = PaperGeometry(0.3);
  return experiment == &kEquilibrium ? MeanFreeTimesOf(pair).ball_piston
                                     : ConditionalMeanFreeTime(pair, 0.125);
}

TEST_P(EachExperiment, ClosedFormsAnswerWithoutABlock) {
  if (!AimOf(spec_).HasClosedForm()) return;
  spec_.model = Model::kClosedForm;
  for (const Target& target : {Target{}, Target{.tolerance = 1e-12}, spec_.target}) {
    spec_.target = target;
    ASSERT_TRUE(Violations(spec_).empty());
    const auto point = PointExperiment::Create(spec_, 1);
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
    EXPECT_EQ(summary.estimates.front().value, FirstClosedForm(spec_.experiment));
  }
}

// Closed form, sampling and their names belong together: a z-score of 5 for 1000 samples.
TEST_P(EachExperiment, ClosedFormsAreNamedAsTheEstimatesTheyStandFor) {
  if (!AimOf(spec_).HasClosedForm()) return;
  const PointSummary measured = RunPoint(spec_);
  spec_.model = Model::kClosedForm;
  const PointSummary exact = PointExperiment::Create(spec_, 0)->Summarize({});
  for (size_t i = 0; i < exact.estimates.size(); ++i) {
    EXPECT_EQ(exact.estimates[i].name, measured.estimates[i].name);
    EXPECT_EQ(exact.estimates[i].value, measured.estimates[i].exact);
    EXPECT_LT(std::fabs(*measured.estimates[i].ZScore()), 5);
  }
}

TEST(PointExperiment, SpectrumAnswersWithoutABlock) {
  const double unit = MeanFreeTimesOf(PaperGeometry(0.2)).ball_piston / 4;
  const auto point = PointExperiment::Create(RelaxationBy(Model::kSpectrum), 0);
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
  const Answer answer = {.model = Model::kSpectrum, .reason = "chosen", .model_error = 0.01};
  const auto point = PointExperiment::Create(RelaxationBy(Model::kAuto), 0, answer);
  EXPECT_EQ(point->answer().model, Model::kSpectrum);
  EXPECT_EQ(point->answer().reason, "chosen");
  EXPECT_EQ(point->answer().model_error, 0.01);
  EXPECT_EQ(point->plan().samples(), 0u);
  // The numbers are the same as if the specification had named the model.
  const auto chosen =
      PointExperiment::Create(RelaxationBy(Model::kAuto), 0, {.model = Model::kMarkov});
  EXPECT_EQ(FoldPoint(*chosen), Folded(RelaxationBy(Model::kMarkov)));
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

TEST(PointExperiment, CollisionsAreSharedByTheOrbitsThatTakeThem) {
  const PointParameters point = PaperPoint(0.2);  // orbits of 40 collisions
  for (const auto& [target, samples] : {std::pair<Target, int64_t>({.collisions = 1000}, 25),
                                        {{.collisions = 1001}, 26},
                                        {{.collisions = 1}, 1},
                                        {{.samples = 1000}, 1000},
                                        {{}, kDefaultSamples},
                                        {{.tolerance = 0.01}, kMaxSamples}}) {
    const EnsembleSpec spec = SpecOf(&kEnergyRelaxation, point, target);
    EXPECT_EQ(SamplesAskedFor(target, ForecastOf(spec, point)), static_cast<uint64_t>(samples));
  }
}

// ---- random_stream.h ----

uint64_t StreamAt(const ExperimentKind& experiment, const PointParameters& point,
                  Model model = Model::kBilliard) {
  return PointStream({.experiment = &experiment, .model = model}, point);
}

TEST(PointStream, TheJumpProcessHasItsOwnRandomNumbers) {
  const PointParameters point = {{kRho, 0.6}, {kDelta, 0.1}};
  const uint64_t billiard = StreamAt(kEnergyRelaxation, point);
  EXPECT_NE(StreamAt(kEnergyRelaxation, point, Model::kMarkov), billiard);
  EXPECT_EQ(StreamAt(kEnergyRelaxation, point, Model::kBilliardReference), billiard);
}

}  // namespace
}  // namespace ballpiston
