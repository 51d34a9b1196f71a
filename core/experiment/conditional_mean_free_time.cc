#include "core/experiment/conditional_mean_free_time.h"

#include "core/experiment/predicted_hits.h"
#include "core/experiment/return_orbits.h"

namespace ballpiston {
namespace {

constexpr double kInvariantExponent = 1;

}  // namespace

ConditionalMeanFreeTimeExperiment::ConditionalMeanFreeTimeExperiment(const EnsembleSpec& spec,
                                                                     const PointParameters& point,
                                                                     const PairGeometry& geometry)
    : PointExperiment(spec, point,
                      PlanBlocks(spec, HitsPerReturn(geometry, *point.epsilon).Events())),
      geometry_(geometry),
      return_time_(geometry, *point.epsilon) {}

std::optional<BlockResult> ConditionalMeanFreeTimeExperiment::RunBlock(uint64_t block,
                                                                       std::stop_token stop) const {
  ReturnOrbits orbits(geometry_, {*parameters().epsilon, kInvariantExponent}, random(),
                      plan().FirstSample(block), plan().SamplesIn(block));
  if (!RunOrbits(engine(), geometry_, plan().SamplesIn(block), orbits, stop)) return std::nullopt;
  BlockResult result = EmptyResult();
  for (const Return& sample : orbits.returns()) {
    if (!Healthy(sample, result.health)) continue;
    ++result.samples;
    result.moments[0].Add(sample.time);
  }
  return result;
}

BlockResult ConditionalMeanFreeTimeExperiment::EmptyResult() const {
  BlockResult result;
  result.moments.resize(1);
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
