// The experiment energy-relaxation (energy_relaxation.h), by the billiard, by the jump process of
// its limit, or by the spectrum of the jump process.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/billiard/lane_constants.h"
#include "core/closed_form/mean_free_time.h"
#include "core/ensemble/chunk_plan.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/energy_relaxation.h"
#include "core/experiment/expected_limit_error.h"
#include "core/experiment/expected_returns.h"
#include "core/experiment/pair_experiment.h"
#include "core/sampling/invariant_measure.h"

namespace ballpiston {
namespace {

// By billiard, billiard_reference or markov, or by spectrum, whose errors are bounds of the
// numerical error.
class EnergyRelaxationExperiment : public PairExperiment {
 public:
  EnergyRelaxationExperiment(const EnsembleSpec& spec, const PointParameters& point)
      : PairExperiment(spec, point), relaxation_(geometry(), point, answer().model) {
    std::vector<Measurement> table = relaxation_.Table();
    if (IsLimit()) table.push_back({"spectral_gap", SpectralGap});
    if (answer().model == Model::kSpectrum) AddRates(table);
    SetMeasurements(relaxation_.Empty(), std::move(table));
  }

  const EnergyRelaxation& relaxation() const { return relaxation_; }

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override;

 protected:
  void AddDetails(const BlockResult& merged, PointSummary& summary) const override {
    const bool is_measured = TakesSamples(answer().model);
    summary.remarks = RemarksOnDecay(relaxation_.epsilon());
    summary.curves = {is_measured ? relaxation_.MeasuredCurve(merged) : relaxation_.CurveOfLimit()};
    summary.histograms = is_measured ? relaxation_.MeasuredLaws(merged) : relaxation_.LawsOfLimit();
  }

 private:
  static Estimate SpectralGap(const BlockResult&) {
    const BoundedValue gap = RelaxationSpectrum::Get().Gap();
    return {.value = gap.value, .standard_error = gap.error};
  }

  // The gap, and the further isolated rates.
  static void AddRates(std::vector<Measurement>& table) {
    size_t number = 0;
    for (const auto& [value, error] : RelaxationSpectrum::Get().IsolatedRates()) {
      std::string name = ++number == 1 ? "spectral_gap" : absl::StrCat("isolated_rate_", number);
      table.push_back({.name = std::move(name), .known = {{value, error}}});
    }
  }

  EnergyRelaxation relaxation_;
};

struct RelaxingOrbit {
  std::optional<StepFunction> energy;  // of an orbit that runs, and of a walk
  std::vector<double> values;          // empty for an escape

  static constexpr uint64_t kWalkedTogether = 256;
  static uint64_t LengthIn(const Block&) { return 1; }

  PairState Start(const EnergyRelaxationExperiment& experiment, const OrbitSamples& samples) {
    CounterRandom random = experiment.random().Sample(samples.first);
    const PairGeometry& geometry = experiment.geometry();
    const std::optional<double>& epsilon = experiment.relaxation().epsilon();
    const PairState state = epsilon ? DrawFromFlowMeasureAt(geometry, *epsilon, random)
                                    : DrawFromFlowMeasure(geometry, random);
    energy.emplace(state.piston_velocity * state.piston_velocity / 2);
    return state;
  }

  AfterCollision Collide(const EnergyRelaxationExperiment& experiment, const Collision& collision) {
    if (!collision.expired) {
      // After the collision the piston has the ball's normal velocity component.
      const double v = collision.state.ball_speed * collision.state.direction.x();
      energy->Add(collision.time, v * v / 2);
      if (!IsComplete(experiment)) return AfterCollision::kGoOn;
    }
    values = experiment.relaxation().Measure(*energy);
    energy.reset();
    return AfterCollision::kEnd;
  }

  double StartOfWalk(const EnergyRelaxationExperiment& experiment, const OrbitSamples& samples) {
    const std::optional<double>& epsilon = experiment.relaxation().epsilon();
    const double u =
        epsilon ? std::sqrt(2 * *epsilon) : experiment.random().Sample(samples.first).Uniform();
    energy.emplace(u * u / 2);
    return u;
  }

  AfterCollision Jump(const EnergyRelaxationExperiment& experiment, double waiting_time, double u) {
    energy->Add(experiment.relaxation().unit() * waiting_time, u * u / 2);
    return IsComplete(experiment) ? AfterCollision::kEnd : AfterCollision::kGoOn;
  }

  // Walks are measured here: measurements between their jumps took 10 % more time.
  void AddTo(const EnergyRelaxationExperiment& experiment, BlockResult& result) const {
    const EnergyRelaxation& relaxation = experiment.relaxation();
    if (!values.empty()) {
      relaxation.Record(values, result);
    } else if (energy && IsComplete(experiment)) {
      relaxation.Record(relaxation.Measure(*energy), result);
    }
  }

  bool IsComplete(const EnergyRelaxationExperiment& experiment) const {
    return energy->last_jump() >= experiment.relaxation().orbit_time();
  }
};

std::unique_ptr<EngineRun> EnergyRelaxationExperiment::StartRun(BlockQueue& queue) const {
  return RunOrbits<RelaxingOrbit>(queue, *this, relaxation_.orbit_time());
}

std::vector<std::vector<double>> ProbabilitiesOfTheLimit(const PointParameters& point) {
  return EnergyRelaxation(GeometryOf(point), point).ProbabilitiesOfLimit();
}

// In the first half of the window.
double ShareThatMeetsEarly(const PointParameters& point) {
  const PairGeometry geometry = GeometryOf(point);
  const double time = kWindowTimes / 2 * MeanFreeTimesOf(geometry).ball_piston;
  return ShareThatMeets(geometry, point[kEpsilon], time);
}

// Of orbits without a collision, in wall hits. A slow ball hits no wall of the `hits` of other
// orbits. An orbit with a slow piston waits in its lane until the lanes look at the time limit,
// which they do after 512 bursts.
double DelayOfOrbitsThatNeverMeet(Model model, const PointParameters& point, double hits) {
  const double share = 1 - ShareThatMeetsEarly(point);
  if (point[kEpsilon] > 0.25) return -share * hits;
  if (model == Model::kBilliardReference) return 0;
  constexpr double kBursts = 512;
  return share * kBursts * static_cast<double>(FlightsInABurst(GeometryOf(point)));
}

// The measurements of a step of the energy take most of a jump's time.
SampleWork WorkOfAnOrbit(Model model, const PointParameters& point) {
  if (model == Model::kMarkov) return SampleWork{.jumps = 1}.Times(CollisionsPerOrbit(point));
  SampleWork step = WorkOfACollision(GeometryOf(point));
  step.jumps = 1;
  SampleWork orbit = step.Times(CollisionsPerOrbit(point));
  if (point.Find(kEpsilon)) {
    orbit.delays = DelayOfOrbitsThatNeverMeet(model, point, orbit.ball_wall);
  }
  return orbit;
}

// An orbit that has ended keeps its numbers until its block is complete. Two blocks are in progress
// at a time, unless they are small.
Forecast ForecastOfAnOrbit(Model model, const PointParameters& point) {
  // In bytes: 34 numbers, the list of the numbers and the list of the energy.
  constexpr double kBlocks = 2, kOfAnOrbit = 320;
  const SampleWork work = WorkOfAnOrbit(model, point);
  const Engine engine = model == Model::kBilliardReference ? Engine::kReference : Engine::kLanes;
  const ChunkPlan plan(kMaxSamples, engine, work.Events());
  const double orbits = kBlocks * static_cast<double>(plan.MostInABlock());
  return {.work = work,
          .collisions = CollisionsPerOrbit(point),
          .memory = kMemoryOfPairs + orbits * kOfAnOrbit};
}

// If the orbits start at an epsilon, the error is that of the integral of (ep - 1/6) dt. If few
// orbits of the billiard meet, the integral has two values, and their shares determine its scatter.
Scatter ScatterOfAnOrbit(Model model, const PointParameters& point) {
  constexpr double kScatter = 0.42;
  const EnergyRelaxation relaxation(GeometryOf(point), point, model);
  Scatter scatter = {1.25, relaxation.events_per_orbit()};
  if (!HasRelaxationTime(relaxation.epsilon())) {
    scatter.error = std::numeric_limits<double>::infinity();
  } else if (relaxation.epsilon()) {
    const double decay = relaxation.IntegralOfLimit().value;
    scatter.error = std::fabs(kScatter * 4 * relaxation.unit() / decay);
    if (model == Model::kMarkov) return scatter;
    const double meet = ShareThatMeetsEarly(point);
    scatter.error = std::min(scatter.error, std::sqrt(meet / (1 - meet)));
  }
  return scatter;
}

std::optional<double> LimitErrorOfRelaxation(const PointParameters& point) {
  if (!HasRelaxationTime(point.Find(kEpsilon))) return std::nullopt;
  return ExpectedLimitError(point);
}

double ErrorOfTheSpectrum(const PointParameters& point) {
  const RelaxationSpectrum& spectrum = RelaxationSpectrum::Get();
  const auto epsilon = point.Find(kEpsilon);
  const auto [value, error] =
      epsilon ? spectrum.DecayIntegral(*epsilon, HUGE_VAL) : spectrum.CorrelationTime(HUGE_VAL);
  return error / std::fabs(value);
}

constexpr ParameterUse kParametersOfRelaxation[] = {
    {&kRho}, {&kDelta}, {.parameter = &kEpsilon, .needed = false}};
constexpr Model kModelsOfRelaxation[] = {Model::kSpectrum, Model::kMarkov, Model::kBilliard,
                                         Model::kBilliardReference};
constexpr absl::string_view kMultiplesOfTheTime[] = {"decay_integral"};

constexpr absl::string_view kNoTime =
    "there is no relaxation time; permitted: epsilon in [0, 0.12] or [0.2, 0.5], or samples, "
    "collisions or a budget";
static_assert(kNoDecayFrom == 0.12 && kNoDecayTo == 0.2);

// Some energies have no relaxation time. A tolerance is not permitted there, and the first estimate
// is the decay integral.
constexpr AimedEstimate kAimsOfRelaxation[] = {{.name = "relaxation_time",
                                                .models = kModelsOfRelaxation,
                                                .scatter = ScatterOfAnOrbit,
                                                .limit_error = LimitErrorOfRelaxation,
                                                .numerical_error = ErrorOfTheSpectrum,
                                                .no_error = kNoTime,
                                                .multiples = kMultiplesOfTheTime}};

}  // namespace

constinit const ExperimentKind kEnergyRelaxation = {
    .name = "energy-relaxation",
    .number = 4,
    .parameters = kParametersOfRelaxation,
    .aims = kAimsOfRelaxation,
    .create = CreateAs<EnergyRelaxationExperiment>,
    .check_grid = CheckPairGrid,
    .forecast = ForecastOfAnOrbit,
    .expected_probabilities = ProbabilitiesOfTheLimit};

}  // namespace ballpiston
