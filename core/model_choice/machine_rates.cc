#include "core/model_choice/machine_rates.h"

#include <algorithm>

#include "core/experiment/energy_relaxation.h"
#include "core/experiment/point_experiment.h"
#include "core/experiment/predicted_hits.h"
#include "core/method_comparison/processor_time.h"

namespace ballpiston {
namespace {

constexpr double kRho = 0.53;
constexpr double kEpsilon = 0.125;
// Where collisions count, and where wall hits do.
constexpr double kLargeDelta = 0.3;
constexpr double kSmallDelta = 0.03;

EnsembleSpec SpecOf(Experiment experiment, Model model, double delta, int64_t count) {
  EnsembleSpec spec = {
      .experiment = experiment, .grid = {.rho = {kRho}, .delta = {delta}}, .model = model};
  if (experiment == Experiment::kEquilibrium) {
    spec.target.collisions = count;
  } else {
    spec.target.samples = count;
  }
  if (experiment == Experiment::kConditionalMeanFreeTime) spec.grid.epsilon = {kEpsilon};
  return spec;
}

// Seconds of one sample; the least of three, which others disturbed least.
double SecondsOfASample(const EnsembleSpec& spec) {
  const auto experiment = PointExperiment::Create(spec, 0);
  double least = 0;
  for (int turn = 0; turn < 3; ++turn) {
    const double begin = ThreadSeconds();
    const auto block = experiment->RunBlock(0, {});
    const double seconds = (ThreadSeconds() - begin) / static_cast<double>(block->samples);
    least = turn == 0 ? seconds : std::min(least, seconds);
  }
  return least;
}

double SecondsOfAPoint(const EnsembleSpec& spec) {
  return SecondsOf([&] { PointExperiment::Create(spec, 0)->Summarize(BlockResult()); });
}

double HitsOf(Engine engine, const PredictedHits& hits) {
  return engine == Engine::kReference ? hits.Events() : hits.ball_wall;
}

// Two lines' slope and what is left of them at each of two experiments.
EngineRate RateOf(Engine engine, int64_t scale) {
  const Model model = engine == Engine::kReference ? Model::kBilliardReference : Model::kBilliard;
  const auto seconds = [&](Experiment experiment, double delta, int64_t count) {
    EnsembleSpec spec = SpecOf(experiment, model, delta, count * static_cast<int64_t>(kMinBlocks));
    if (engine == Engine::kLanesSingle) spec.precision = Precision::kSingle;
    return SecondsOfASample(spec);
  };
  const PairGeometry large = PairGeometry::Create(kRho, kLargeDelta).value();
  const PairGeometry small = PairGeometry::Create(kRho, kSmallDelta).value();
  const double few = HitsOf(engine, HitsPerCollision(large));
  const double many = HitsOf(engine, HitsPerCollision(small));
  const double dear = seconds(Experiment::kEquilibrium, kSmallDelta, 8 * scale);
  const double cheap = seconds(Experiment::kEquilibrium, kLargeDelta, 32 * scale);
  EngineRate rate;
  rate.wall_hit = std::max(dear - cheap, 0.0) / (many - few);
  rate.collision = std::max(cheap - few * rate.wall_hit, 0.0);
  const double returns = seconds(Experiment::kConditionalMeanFreeTime, kLargeDelta, 8 * scale);
  const double hits = HitsOf(engine, HitsPerReturn(large, kEpsilon));
  // On a busy machine the difference may be anything.
  constexpr double kLeastShare = 0.01;
  rate.sample = std::max({returns - hits * rate.wall_hit, rate.collision, kLeastShare * returns});
  return rate;
}

}  // namespace

const EngineRate& MachineRates::Of(Engine engine) const {
  if (engine == Engine::kReference) return reference;
  return engine == Engine::kLanesSingle ? lanes_single : lanes;
}

MachineRates MeasureMachineRates() {
  RelaxationSpectrum::Get();  // made once
  MachineRates rates;
  rates.closed_form =
      SecondsOfAPoint(SpecOf(Experiment::kEquilibrium, Model::kClosedForm, kLargeDelta, 1));
  rates.spectrum =
      SecondsOfAPoint(SpecOf(Experiment::kEnergyRelaxation, Model::kSpectrum, kLargeDelta, 1));
  const EnsembleSpec walk =
      SpecOf(Experiment::kEnergyRelaxation, Model::kMarkov, kLargeDelta, 2048 * kMinBlocks);
  rates.jump = SecondsOfASample(walk) / CollisionsPerOrbit(PointAt(walk, 0));
  rates.lanes = RateOf(Engine::kLanes, 256);
  rates.lanes_single = RateOf(Engine::kLanesSingle, 256);
  rates.reference = RateOf(Engine::kReference, 16);
  return rates;
}

}  // namespace ballpiston
