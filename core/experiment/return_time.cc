#include "core/experiment/return_time.h"

#include <utility>

#include "core/closed_form/conditional_rate.h"
#include "core/experiment/long_returns.h"

namespace ballpiston {

ReturnTime::ReturnTime(const PairGeometry& geometry, double epsilon)
    : exact_mean_(ConditionalMeanFreeTime(geometry, epsilon)),
      long_returns_per_sample_(LongReturnsPerSample(geometry, epsilon)) {}

bool ReturnTime::TellsItsError(const Moments& times) const {
  return static_cast<double>(times.count) * long_returns_per_sample_ >= kEnoughLongReturns;
}

Estimate ReturnTime::Mean(std::string name, const Moments& times) const {
  return {.name = std::move(name),
          .value = times.mean,
          .standard_error = TellsItsError(times) ? times.StandardError() : std::nullopt};
}

std::optional<Estimate> ReturnTime::CoefficientOfVariation(const Moments& times) const {
  const std::optional<double> value = times.CoefficientOfVariation();
  if (!TellsItsError(times) || !value) return std::nullopt;
  return Estimate{.name = "coefficient_of_variation",
                  .value = *value,
                  .standard_error = times.CoefficientOfVariationError()};
}

}  // namespace ballpiston
