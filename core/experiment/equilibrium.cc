#include "core/experiment/equilibrium.h"

#include "core/billiard/reference_flow.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/flight_to_collision.h"
#include "core/experiment/point_stream.h"
#include "core/sampling/invariant_measure.h"

namespace ballpiston {
namespace {

double EventsPerCollision(const PairGeometry& geometry) {
  const MeanFreeTimes tau = MeanFreeTimesOf(geometry);
  return 1 + tau.ball_piston / tau.ball_wall + tau.ball_piston / tau.piston_wall;
}

Estimate MeanFreeTime(absl::string_view between, const BlockResult& merged, size_t index,
                      double exact) {
  const BatchMeans& measured = merged.batch_means[index];
  const bool enough = merged.samples >= kCollisionsForAnError;
  return {.name = "mean_free_time_" + std::string(between),
          .value = measured.Ratio().value_or(0),
          .standard_error = enough ? measured.StandardError() : std::nullopt,
          .exact = exact};
}

}  // namespace

EquilibriumExperiment::EquilibriumExperiment(const EnsembleSpec& spec, const PointParameters& point,
                                             const PairGeometry& geometry)
    : PointExperiment(point, PlanBlocks(spec.target, EventsPerCollision(geometry))),
      geometry_(geometry),
      seed_(spec.seed),
      stream_(PointStream(spec.experiment, point)) {}

std::optional<BlockResult> EquilibriumExperiment::RunBlock(uint64_t block,
                                                           std::stop_token stop) const {
  CounterRandom random(seed_, stream_, plan().FirstSample(block));
  ReferenceFlow flow(geometry_, DrawFromCollisionMeasure(geometry_, random));
  BlockResult result;
  double time = 0, ball_wall = 0, piston_wall = 0;
  while (result.samples < plan().SamplesIn(block)) {
    const std::optional<Flight> flight = FlyToCollision(flow, stop);
    if (!flight) return std::nullopt;
    if (flight->escaped) {
      ++result.health.escapes;
      break;
    }
    flow.ExchangeComponents();
    ++result.samples;
    time += flight->time;
    ball_wall += static_cast<double>(flight->ball_wall_hits);
    piston_wall += static_cast<double>(flight->piston_wall_hits);
  }
  result.health.max_energy_error = EnergyError(flow.state());
  result.batch_means.resize(3);
  result.batch_means[0].Add(time, static_cast<double>(result.samples));
  result.batch_means[1].Add(time, ball_wall);
  result.batch_means[2].Add(time, piston_wall);
  return result;
}

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
