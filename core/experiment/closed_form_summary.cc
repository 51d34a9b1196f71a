#include "core/experiment/closed_form_summary.h"

#include <utility>

#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/mean_free_time.h"

namespace ballpiston {
namespace {

Estimate Exact(std::string name, double value, double relative_error) {
  return {.name = std::move(name),
          .value = value,
          .standard_error = relative_error * value,
          .exact = value};
}

PointSummary EquilibriumSummary(const PairGeometry& geometry) {
  const MeanFreeTimes tau = MeanFreeTimesOf(geometry);
  return {.estimates = {
              Exact("mean_free_time_ball_piston", tau.ball_piston, kMeanFreeTimeRelativeError),
              Exact("mean_free_time_ball_wall", tau.ball_wall, kMeanFreeTimeRelativeError),
              Exact("mean_free_time_piston_wall", tau.piston_wall, kMeanFreeTimeRelativeError)}};
}

PointSummary ConditionalSummary(const PairGeometry& geometry, double epsilon) {
  return {
      .estimates = {Exact("mean_free_time_conditional", ConditionalMeanFreeTime(geometry, epsilon),
                          kMeanFreeTimeRelativeError + kConditionalRateRelativeError)}};
}

}  // namespace

PointSummary ClosedFormSummary(Experiment experiment, const PairGeometry& geometry,
                               const PointParameters& point) {
  if (experiment == Experiment::kEquilibrium) return EquilibriumSummary(geometry);
  return ConditionalSummary(geometry, *point.epsilon);
}

}  // namespace ballpiston
