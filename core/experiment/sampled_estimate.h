// Estimates from a sample, with errors if the sample has enough events (statistics/told_error.h).
//
// Without samples the value is NaN, and there is no error.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/ensemble/point_summary.h"
#include "core/statistics/batch_means.h"
#include "core/statistics/moments.h"
#include "core/statistics/told_error.h"

namespace ballpiston {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

inline Estimate SampledMean(std::string name, const Moments& sample, double events) {
  const double value = sample.count == 0 ? kNotMeasured : sample.mean;
  return {.name = std::move(name),
          .value = value,
          .standard_error = ToldError(events, value, sample.StandardError()),
          .batches = sample.EffectiveCount()};
}

inline Estimate SampledRatio(std::string name, const BatchMeans& sample, double events) {
  const double value = sample.Ratio().value_or(kNotMeasured);
  return {.name = std::move(name),
          .value = value,
          .standard_error = ToldError(events, value, sample.StandardError()),
          .batches = sample.batches};
}

}  // namespace ballpiston
