// The pair in equilibrium: mean times between collisions of ball and piston, ball and wall, piston
// and wall (the paper's eqs. taubpmft and tauwall).
//
// A block is many orbits of a few collisions. Each orbit starts from the return map's invariant
// measure. So orbits need no relaxation and are independent. Each is one batch of the batch means:
// its duration over its number of collisions of each kind.
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/pair_experiment.h"

namespace ballpiston {
namespace {

// One collision in ten counts as an event for the error (statistics/stated_error.h), because long
// flights are rare and skew the law of the ratio: the z-scores of 100 seeds with 64 collisions had
// variance 1.35.
constexpr double kEventsPerCollision = 0.1;

// About this many orbits are in a block, if it has as many collisions: enough batches for an error.
constexpr uint64_t kOrbitsPerBlock = 256;

enum Hit : size_t { kBallPiston, kBallWall, kPistonWall, kHits };
constexpr const char* kNamesOfTimes[kHits] = {
    "mean_free_time_ball_piston", "mean_free_time_ball_wall", "mean_free_time_piston_wall"};

std::array<double, kHits> ExactTimes(const PairGeometry& geometry) {
  const MeanFreeTimes tau = MeanFreeTimesOf(geometry);
  return {tau.ball_piston, tau.ball_wall, tau.piston_wall};
}

struct TimedOrbit : OrbitInEquilibrium {
  double time = 0;
  std::array<uint64_t, kHits> hits = {};

  static uint64_t LengthIn(const Block& block) {
    return std::max<uint64_t>(block.samples / kOrbitsPerBlock, 1);
  }

  AfterCollision Collide(const PairExperiment&, const Collision& collision) {
    time += collision.time;
    hits[kBallPiston] += 1;
    hits[kBallWall] += collision.ball_wall_hits;
    hits[kPistonWall] += collision.piston_wall_hits;
    return Count();
  }

  void AddTo(const PairExperiment&, BlockResult& result) const {
    result.samples += collisions;
    for (size_t hit = 0; hit < kHits; ++hit) {
      result.batch_means[hit].Add(time, static_cast<double>(hits[hit]));
    }
  }
};

class EquilibriumExperiment : public PairExperiment {
 public:
  EquilibriumExperiment(const EnsembleSpec& spec, const PointParameters& point)
      : PairExperiment(spec, point) {
    std::vector<Measurement> table;
    const std::array<double, kHits> exact = ExactTimes(geometry());
    for (size_t hit = 0; hit < kHits; ++hit) {
      table.push_back({.name = kNamesOfTimes[hit],
                       .reading = RatioAt(hit, kEventsPerCollision),
                       .exact = exact[hit],
                       .known = {{exact[hit], kMeanFreeTimeRelativeError * exact[hit]}}});
    }
    SetMeasurements({.batch_means = std::vector<BatchMeans>(kHits)}, std::move(table));
  }

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override {
    return RunOrbits<TimedOrbit>(queue, *this);
  }
};

Forecast ForecastOfEquilibrium(Model, const PointParameters& point) {
  return {.work = WorkOfACollision(GeometryOf(point)), .memory = kMemoryOfPairs};
}

Scatter ScatterOfTimes(Model, const PointParameters&) { return {1.05, kEventsPerCollision}; }

constexpr Model kModelsOfEquilibrium[] = {Model::kClosedForm, Model::kBilliard,
                                          Model::kBilliardReference};

constexpr AimedEstimate kAimsOfEquilibrium[] = {{.name = kNamesOfTimes[kBallPiston],
                                                 .models = kModelsOfEquilibrium,
                                                 .scatter = ScatterOfTimes,
                                                 .numerical_error = ErrorOfClosedForms}};

}  // namespace

constinit const ExperimentKind kEquilibrium = {.name = "equilibrium",
                                               .number = 1,
                                               .parameters = kPairAlone,
                                               .aims = kAimsOfEquilibrium,
                                               .create = CreateAs<EquilibriumExperiment>,
                                               .check_grid = CheckPairGrid,
                                               .forecast = ForecastOfEquilibrium};

}  // namespace ballpiston
