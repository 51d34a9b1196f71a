// Measures the sampling rates of this machine.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/billiard/orbits.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/expected_returns.h"
#include "server/compute/model_ladder.h"
#include "server/processor_time.h"

namespace ballpiston::server {
namespace {

constexpr double kSomeRho = 0.53;
constexpr double kSomeEpsilon = 0.125;
// At the large delta collisions dominate the cost, at the small one wall hits.
constexpr double kLargeDelta = 0.3;
constexpr double kSmallDelta = 0.03;

EnsembleSpec SpecOf(const ExperimentKind& experiment, Model model, double delta) {
  EnsembleSpec spec = {
      .experiment = &experiment, .grid = {{kRho, {kSomeRho}}, {kDelta, {delta}}}, .model = model};
  if (&experiment == &kConditionalMeanFreeTime) spec.grid[kEpsilon] = {kSomeEpsilon};
  return spec;
}

// Counts the orbits that an engine starts before the first one ends: its lanes.
class FirstOrbits : public OrbitSource {
 public:
  explicit FirstOrbits(const PairGeometry& geometry) : geometry_(geometry) {}
  // The ball flies away from a piston at rest, so no orbit ends in the first flights.
  std::optional<OrbitStart> Next() override {
    if (one_has_ended_) return std::nullopt;
    return OrbitStart{
        count_++,
        {.direction = {-M_SQRT1_2, -M_SQRT1_2}, .ball_speed = 1, .piston = geometry_.tip()}};
  }
  AfterCollision Collide(uint64_t, const Collision&) override {
    one_has_ended_ = true;
    return AfterCollision::kEnd;
  }
  bool Pause() override { return false; }
  double count() const { return static_cast<double>(count_); }

 private:
  PairGeometry geometry_;
  uint64_t count_ = 0;
  bool one_has_ended_ = false;
};

double LanesOf(Engine engine, const PairGeometry& geometry) {
  FirstOrbits orbits(geometry);
  StartOrbits(engine, geometry, orbits)->Advance();
  return orbits.count();
}

// Seconds per sample: the smallest of three measurements, because other programs only add time.
double SecondsOfASample(const EnsembleSpec& spec, uint64_t samples) {
  assert(Violations(spec).empty());
  const auto experiment = PointExperiment::Create(spec, 0);
  double least = 0;
  for (int turn = 0; turn < 3; ++turn) {
    const double begin = ThreadSeconds();
    RunBlock(*experiment, {.samples = samples});
    const double seconds = (ThreadSeconds() - begin) / static_cast<double>(samples);
    least = turn == 0 ? seconds : std::min(least, seconds);
  }
  return least;
}

double HitsOf(Engine engine, const PredictedHits& hits) {
  return engine == Engine::kReference ? hits.Events() : hits.ball_wall;
}

// The slope over wall hits gives the cost of a hit. What remains of two experiments gives the costs
// of a collision and of a sample.
EngineRate RateOf(Engine engine, uint64_t scale) {
  const Model model = engine == Engine::kReference ? Model::kBilliardReference : Model::kBilliard;
  const auto seconds = [&](const ExperimentKind& experiment, double delta, uint64_t samples) {
    EnsembleSpec spec = SpecOf(experiment, model, delta);
    if (engine == Engine::kLanesSingle) spec.precision = Precision::kSingle;
    return SecondsOfASample(spec, samples);
  };
  const PairGeometry large = PairGeometry::Create(kSomeRho, kLargeDelta).value();
  const PairGeometry small = PairGeometry::Create(kSomeRho, kSmallDelta).value();
  const double few = HitsOf(engine, HitsPerCollision(large));
  const double many = HitsOf(engine, HitsPerCollision(small));
  const double dear = seconds(kEquilibrium, kSmallDelta, 8 * scale);
  const double cheap = seconds(kEquilibrium, kLargeDelta, 32 * scale);
  EngineRate rate;
  rate.wall_hit = std::max(dear - cheap, 0.0) / (many - few);
  rate.collision = std::max(cheap - few * rate.wall_hit, 0.0);
  const double returns = seconds(kConditionalMeanFreeTime, kLargeDelta, 8 * scale);
  const double hits = HitsOf(engine, HitsPerReturn(large, kSomeEpsilon));
  // On a busy machine the difference can even be negative.
  constexpr double kLeastShare = 0.01;
  rate.sample = std::max({returns - hits * rate.wall_hit, rate.collision, kLeastShare * returns});
  rate.lanes = LanesOf(engine, large);
  return rate;
}

}  // namespace

MachineRates MeasureSamplingRates() {
  MachineRates rates;
  const EnsembleSpec walk = SpecOf(kEnergyRelaxation, Model::kMarkov, kLargeDelta);
  rates.jump = SecondsOfASample(walk, 2048) / ForecastOf(walk, PointAt(walk, 0)).collisions;
  rates.lanes = RateOf(Engine::kLanes, 256);
  rates.lanes_single = RateOf(Engine::kLanesSingle, 256);
  rates.reference = RateOf(Engine::kReference, 16);
  return rates;
}

}  // namespace ballpiston::server
