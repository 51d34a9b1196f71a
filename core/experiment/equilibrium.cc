// The pair in equilibrium: mean times between collisions of ball and piston, ball and wall, piston
// and wall (the paper's eqs. taubpmft and tauwall).
//
// A block is many orbits of a few collisions. Each orbit starts from the return map's invariant
// measure. So orbits need no relaxation and are independent. Each is one batch of the batch means:
//   [0] (time, ball-piston collisions)  [1] (time, ball-wall hits)  [2] (time, piston-wall hits).
#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "absl/strings/str_format.h"
#include "core/billiard/orbits.h"
#include "core/closed_form/mean_free_time.h"
#include "core/ensemble/block_orbits.h"
#include "core/ensemble/computed_answer.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/exact_estimate.h"
#include "core/experiment/pair_experiment.h"
#include "core/experiment/return_orbits.h"
#include "core/experiment/sampled_estimate.h"
#include "core/sampling/invariant_measure.h"

namespace ballpiston {
namespace {

// One collision in ten counts as an event for the error (statistics/told_error.h), because long
// flights are rare and skew the law of the ratio: the z-scores of 100 seeds with 64 collisions had
// variance 1.35.
constexpr double kEventsPerCollision = 0.1;

// About this many orbits are in a block, if it has as many collisions: enough batches for an error.
constexpr uint64_t kOrbitsPerBlock = 256;

double EventsIn(const BlockResult& merged) {
  return kEventsPerCollision * static_cast<double>(merged.samples);
}

Estimate MeanFreeTime(absl::string_view between, const BlockResult& merged, size_t index,
                      double exact) {
  const BatchMeans& measured = merged.batch_means[index];
  Estimate time =
      SampledRatio("mean_free_time_" + std::string(between), measured, EventsIn(merged));
  time.exact = exact;
  return time;
}

// Three batch means, ball-piston, ball-wall and piston-wall, with one batch an orbit.
BlockResult EmptyCounts() {
  BlockResult counts;
  counts.batch_means.resize(3);
  return counts;
}

// A block's collisions, over orbits that start at numbers first, first + length, ...
class EquilibriumOrbits {
 public:
  EquilibriumOrbits(const PairGeometry& geometry, const RandomStream& random, const Block& block)
      : geometry_(geometry),
        random_(random),
        first_(block.first),
        collisions_(block.samples),
        length_(std::max<uint64_t>(collisions_ / kOrbitsPerBlock, 1)),
        orbits_((collisions_ + length_ - 1) / length_) {}

  uint64_t count() const { return orbits_.size(); }

  PairState Start(uint64_t orbit) {
    CounterRandom random = random_.Sample(first_ + orbit * length_);
    return DrawFromCollisionMeasure(geometry_, random);
  }

  AfterContact Meet(uint64_t orbit, const Contact& contact) {
    Orbit& sums = orbits_[orbit];
    if (contact.escaped) {
      ++sums.health.escapes;
      return AfterContact::kEnd;
    }
    ++sums.collisions;
    sums.time += contact.time;
    sums.ball_wall += static_cast<double>(contact.ball_wall_hits);
    sums.piston_wall += static_cast<double>(contact.piston_wall_hits);
    sums.health.max_energy_error =
        std::max(sums.health.max_energy_error, EnergyError(contact.state));
    const uint64_t last = std::min(length_, collisions_ - orbit * length_);
    return sums.collisions < last ? AfterContact::kGoOn : AfterContact::kEnd;
  }

  BlockResult Result() const {
    BlockResult result = EmptyCounts();
    for (const Orbit& orbit : orbits_) {
      result.samples += orbit.collisions;
      result.batch_means[0].Add(orbit.time, static_cast<double>(orbit.collisions));
      result.batch_means[1].Add(orbit.time, orbit.ball_wall);
      result.batch_means[2].Add(orbit.time, orbit.piston_wall);
      result.health.Merge(orbit.health);
    }
    return result;
  }

 private:
  struct Orbit {
    uint64_t collisions = 0;
    double time = 0;
    double ball_wall = 0;
    double piston_wall = 0;
    Health health;
  };

  PairGeometry geometry_;
  RandomStream random_;
  uint64_t first_;
  uint64_t collisions_;
  uint64_t length_;
  std::vector<Orbit> orbits_;
};

class EquilibriumExperiment : public PointExperiment {
 public:
  EquilibriumExperiment(const EnsembleSpec& spec, const PointParameters& point)
      : PointExperiment(spec, point), geometry_(GeometryOf(point)) {}

  std::unique_ptr<BlockRun> StartRun(BlockQueue& queue) const override {
    return RunBlockOrbits(
        engine(), geometry_, kNoTimeLimit,
        [this](const Block& block) { return EquilibriumOrbits(geometry_, random(), block); },
        queue);
  }

  BlockResult EmptyResult() const override { return EmptyCounts(); }

  Estimate FirstEstimate(const BlockResult& merged) const override {
    return MeanFreeTime("ball_piston", merged, 0, MeanFreeTimesOf(geometry_).ball_piston);
  }

  PointSummary Summarize(const BlockResult& merged) const override {
    const MeanFreeTimes exact = MeanFreeTimesOf(geometry_);
    PointSummary summary = {
        .samples = merged.samples,
        .estimates = {FirstEstimate(merged), MeanFreeTime("ball_wall", merged, 1, exact.ball_wall),
                      MeanFreeTime("piston_wall", merged, 2, exact.piston_wall)},
        .health = merged.health};
    if (!TellsItsError(EventsIn(merged))) {
      summary.remarks.push_back(
          absl::StrFormat("there are no standard errors: these need %.0f collisions",
                          kEventsForAnError / kEventsPerCollision));
    }
    return summary;
  }

 private:
  PairGeometry geometry_;
};

PointSummary ExactTimes(const PairGeometry& geometry) {
  const MeanFreeTimes tau = MeanFreeTimesOf(geometry);
  const auto exact = [](const char* name, double time) {
    return ExactEstimate(name, time, kMeanFreeTimeRelativeError);
  };
  return {.estimates = {exact("mean_free_time_ball_piston", tau.ball_piston),
                        exact("mean_free_time_ball_wall", tau.ball_wall),
                        exact("mean_free_time_piston_wall", tau.piston_wall)}};
}

std::unique_ptr<PointExperiment> CreateEquilibrium(const EnsembleSpec& spec,
                                                   const PointParameters& point) {
  if (spec.model != Model::kClosedForm) {
    return std::make_unique<EquilibriumExperiment>(spec, point);
  }
  return std::make_unique<ComputedAnswer>(spec, point, ExactTimes(GeometryOf(point)));
}

SampleWork WorkInEquilibrium(Model, const PointParameters& point) {
  return WorkOfACollision(GeometryOf(point));
}

double ErrorInEquilibrium(Model, const PointParameters&) { return 1.05; }
double EventsInEquilibrium(Model, const PointParameters&) { return kEventsPerCollision; }

constexpr Model kModelsOfEquilibrium[] = {Model::kClosedForm, Model::kBilliard,
                                          Model::kBilliardReference};

constexpr AimedEstimate kAimsOfEquilibrium[] = {{.name = "mean_free_time_ball_piston",
                                                 .models = kModelsOfEquilibrium,
                                                 .error = ErrorInEquilibrium,
                                                 .events = EventsInEquilibrium}};

}  // namespace

constinit const ExperimentKind kEquilibrium = {.name = "equilibrium",
                                               .number = 1,
                                               .parameters = kPairAlone,
                                               .unit = TargetUnit::kCollisions,
                                               .models = kModelsOfEquilibrium,
                                               .aims = kAimsOfEquilibrium,
                                               .create = CreateEquilibrium,
                                               .check_grid = CheckPairGrid,
                                               .work = WorkInEquilibrium,
                                               .collisions = OneCollision,
                                               .memory = MemoryOfPairs};

}  // namespace ballpiston
