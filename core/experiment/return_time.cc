#include "core/experiment/return_time.h"

#include <algorithm>
#include <utility>

#include "core/closed_form/conditional_rate.h"
#include "core/experiment/long_returns.h"
#include "core/statistics/told_error.h"

namespace ballpiston {

ReturnTime::ReturnTime(const PairGeometry& geometry, double epsilon)
    : exact_mean_(ConditionalMeanFreeTime(geometry, epsilon)),
      long_returns_per_sample_(LongReturnsPerSample(geometry, epsilon)) {}

double ReturnTime::EventsIn(const Moments& times) const {
  return static_cast<double>(times.count) * std::min(long_returns_per_sample_, 1.0);
}

Estimate ReturnTime::Mean(std::string name, const Moments& times) const {
  return {.name = std::move(name),
          .value = times.mean,
          .standard_error = ToldError(EventsIn(times), times.StandardError())};
}

std::optional<Estimate> ReturnTime::CoefficientOfVariation(const Moments& times) const {
  const std::optional<double> value = times.CoefficientOfVariation();
  if (!TellsItsError(EventsIn(times)) || !value) return std::nullopt;
  return Estimate{.name = "coefficient_of_variation",
                  .value = *value,
                  .standard_error = times.CoefficientOfVariationError()};
}

}  // namespace ballpiston
