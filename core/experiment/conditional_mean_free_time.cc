// The mean return time to the ball-piston collision surface at fixed energies, started from the
// invariant law (the paper's eq. taubpmftep). The closed form is exact at every delta, so this is a
// test of the billiard, not of the limit. Moments: [0] return time.
#include <memory>

#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/mean_free_time.h"
#include "core/ensemble/block_orbits.h"
#include "core/ensemble/computed_answer.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/exact_estimate.h"
#include "core/experiment/pair_experiment.h"
#include "core/experiment/return_experiment.h"
#include "core/experiment/return_orbits.h"
#include "core/experiment/return_time.h"

namespace ballpiston {
namespace {

constexpr double kInvariantExponent = 1;

BlockResult NoReturns() {
  BlockResult result;
  result.moments.resize(1);
  return result;
}

class TimedReturns : public ReturnOrbits {
 public:
  using ReturnOrbits::ReturnOrbits;

  BlockResult Result() const {
    BlockResult result = NoReturns();
    for (const Return& sample : returns()) {
      if (!Healthy(sample, result.health)) continue;
      ++result.samples;
      result.moments[0].Add(sample.time);
    }
    return result;
  }
};

class ConditionalMeanFreeTimeExperiment : public PointExperiment {
 public:
  ConditionalMeanFreeTimeExperiment(const EnsembleSpec& spec, const PointParameters& point)
      : PointExperiment(spec, point),
        geometry_(GeometryOf(point)),
        return_time_(geometry_, point[kEpsilon]) {}

  std::unique_ptr<BlockRun> StartRun(BlockQueue& queue) const override {
    const ReturnLaw law = {parameters()[kEpsilon], kInvariantExponent};
    return RunBlockOrbits(
        engine(), geometry_, kNoTimeLimit,
        [this, law](const Block& block) { return TimedReturns(geometry_, law, random(), block); },
        queue);
  }

  BlockResult EmptyResult() const override { return NoReturns(); }

  Estimate FirstEstimate(const BlockResult& merged) const override {
    Estimate mean = return_time_.Mean("mean_free_time_conditional", merged.moments[0]);
    mean.exact = return_time_.exact_mean();
    return mean;
  }

  PointSummary Summarize(const BlockResult& merged) const override {
    PointSummary summary = {.samples = merged.samples, .health = merged.health};
    summary.estimates.push_back(FirstEstimate(merged));
    if (const auto variation = return_time_.CoefficientOfVariation(merged.moments[0])) {
      summary.estimates.push_back(*variation);
    }
    if (const auto remark = return_time_.Remark(merged.moments[0])) {
      summary.remarks.push_back(*remark);
    }
    return summary;
  }

 private:
  PairGeometry geometry_;
  ReturnTime return_time_;
};

std::unique_ptr<PointExperiment> CreateConditional(const EnsembleSpec& spec,
                                                   const PointParameters& point) {
  if (spec.model != Model::kClosedForm) {
    return std::make_unique<ConditionalMeanFreeTimeExperiment>(spec, point);
  }
  const double time = ConditionalMeanFreeTime(GeometryOf(point), point[kEpsilon]);
  const double error = kMeanFreeTimeRelativeError + kConditionalRateRelativeError;
  return std::make_unique<ComputedAnswer>(
      spec, point,
      PointSummary{.estimates = {ExactEstimate("mean_free_time_conditional", time, error)}});
}

constexpr ParameterUse kParametersOfReturns[] = {{&kRho}, {&kDelta}, {&kEpsilon}};
constexpr Model kModelsOfReturns[] = {Model::kClosedForm, Model::kBilliard,
                                      Model::kBilliardReference};

constexpr AimedEstimate kAimsOfReturns[] = {{.name = "mean_free_time_conditional",
                                             .models = kModelsOfReturns,
                                             .error = ErrorOfAReturn,
                                             .events = EventsOfAReturn}};

}  // namespace

constinit const ExperimentKind kConditionalMeanFreeTime = {
    .name = "conditional-mean-free-time",
    .number = 2,
    .parameters = kParametersOfReturns,
    .unit = TargetUnit::kSamples,
    .models = kModelsOfReturns,
    .aims = kAimsOfReturns,
    .create = CreateConditional,
    .check_grid = CheckPairGrid,
    .check_tolerance = CheckToleranceOfReturns,
    .work = WorkOfAReturn,
    .collisions = OneCollision,
    .memory = MemoryOfPairs};

}  // namespace ballpiston
