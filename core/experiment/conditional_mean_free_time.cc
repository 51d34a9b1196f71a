#include "core/experiment/conditional_mean_free_time.h"

#include "core/experiment/point_stream.h"

namespace ballpiston {
namespace {

constexpr double kInvariantExponent = 1;

}  // namespace

ConditionalMeanFreeTimeExperiment::ConditionalMeanFreeTimeExperiment(const EnsembleSpec& spec,
                                                                     const PointParameters& point,
                                                                     const PairGeometry& geometry)
    : PointExperiment(point, PlanBlocks(spec.target, EventsPerReturn(geometry, *point.epsilon))),
      orbit_(geometry, *point.epsilon, kInvariantExponent),
      return_time_(geometry, *point.epsilon),
      seed_(spec.seed),
      stream_(PointStream(spec.experiment, point)) {}

std::optional<BlockResult> ConditionalMeanFreeTimeExperiment::RunBlock(uint64_t block,
                                                                       std::stop_token stop) const {
  BlockResult result;
  result.moments.resize(1);
  const uint64_t first = plan().FirstSample(block);
  for (uint64_t i = 0; i < plan().SamplesIn(block); ++i) {
    const auto hit = orbit_.Run(CounterRandom(seed_, stream_, first + i), stop);
    if (!hit) return std::nullopt;
    result.health.Merge(hit->health);
    if (hit->health.escapes != 0) continue;
    ++result.samples;
    result.moments[0].Add(hit->time);
  }
  return result;
}

Estimate ConditionalMeanFreeTimeExperiment::FirstEstimate(const BlockResult& merged) const {
  Estimate mean = return_time_.Mean("mean_free_time_conditional", merged.moments[0]);
  mean.exact = return_time_.exact_mean();
  return mean;
}

PointSummary ConditionalMeanFreeTimeExperiment::Summarize(const BlockResult& merged) const {
  PointSummary summary = {.samples = merged.samples, .health = merged.health};
  summary.estimates.push_back(FirstEstimate(merged));
  if (const auto variation = return_time_.CoefficientOfVariation(merged.moments[0])) {
    summary.estimates.push_back(*variation);
  }
  return summary;
}

}  // namespace ballpiston
