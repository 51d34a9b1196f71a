#include "core/experiment/equilibrium.h"

#include <algorithm>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/predicted_hits.h"
#include "core/sampling/invariant_measure.h"
#include "core/statistics/told_error.h"

namespace ballpiston {
namespace {

Estimate MeanFreeTime(absl::string_view between, const BlockResult& merged, size_t index,
                      double exact) {
  const BatchMeans& measured = merged.batch_means[index];
  const double events = kEventsPerCollision * static_cast<double>(merged.samples);
  return {.name = "mean_free_time_" + std::string(between),
          .value = measured.Ratio().value_or(0),
          .standard_error = ToldError(events, measured.StandardError()),
          .exact = exact};
}

// Ball-piston, ball-wall, piston-wall: an orbit each.
BlockResult EmptyCounts() {
  BlockResult counts;
  counts.batch_means.resize(3);
  return counts;
}

// `collisions` of them over orbits that start at numbers first, first + length, ...
class EquilibriumOrbits : public OrbitSource {
 public:
  EquilibriumOrbits(const PairGeometry& geometry, const RandomStream& random, uint64_t first,
                    uint64_t collisions)
      : geometry_(geometry),
        random_(random),
        first_(first),
        collisions_(collisions),
        length_(std::max<uint64_t>(collisions / kOrbitsPerBlock, 1)),
        orbits_((collisions + length_ - 1) / length_) {}

  uint64_t count() const { return orbits_.size(); }

  PairState Start(uint64_t orbit) override {
    CounterRandom random = random_.Sample(first_ + orbit * length_);
    return DrawFromCollisionMeasure(geometry_, random);
  }

  AfterContact Meet(uint64_t orbit, const Contact& contact) override {
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

}  // namespace

EquilibriumExperiment::EquilibriumExperiment(const EnsembleSpec& spec, const PointParameters& point,
                                             const PairGeometry& geometry)
    : PointExperiment(spec, point, PlanBlocks(spec, HitsPerCollision(geometry).Events())),
      geometry_(geometry) {}

std::optional<BlockResult> EquilibriumExperiment::RunBlock(uint64_t block,
                                                           std::stop_token stop) const {
  EquilibriumOrbits orbits(geometry_, random(), plan().FirstSample(block), plan().SamplesIn(block));
  if (!RunOrbits(engine(), geometry_, orbits.count(), orbits, stop)) return std::nullopt;
  return orbits.Result();
}

BlockResult EquilibriumExperiment::EmptyResult() const { return EmptyCounts(); }

Estimate EquilibriumExperiment::FirstEstimate(const BlockResult& merged) const {
  return MeanFreeTime("ball_piston", merged, 0, MeanFreeTimesOf(geometry_).ball_piston);
}

PointSummary EquilibriumExperiment::Summarize(const BlockResult& merged) const {
  const MeanFreeTimes exact = MeanFreeTimesOf(geometry_);
  return {
      .samples = merged.samples,
      .estimates = {FirstEstimate(merged), MeanFreeTime("ball_wall", merged, 1, exact.ball_wall),
                    MeanFreeTime("piston_wall", merged, 2, exact.piston_wall)},
      .health = merged.health};
}

}  // namespace ballpiston
