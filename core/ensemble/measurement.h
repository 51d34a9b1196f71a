// The table of an experiment: one row for each estimate, in the order of the answer, except for
// those that AddDetails adds (point_experiment.h). A tolerance refers to the first row.
//
// A standard error is stated if the sample contains enough of the events that determine the
// estimate (statistics/stated_error.h). Without samples the value is NaN, and there is no error.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/arithmetic/bounded_value.h"
#include "core/ensemble/block_result.h"
#include "core/ensemble/point_summary.h"
#include "core/statistics/stated_error.h"

namespace ballpiston {

// Reads an estimate, still without its name, from merged blocks. Empty if the sample is too small
// for this estimate.
using Reading = std::function<std::optional<Estimate>(const BlockResult& merged)>;

struct Measurement {
  std::string name;
  Reading reading = nullptr;  // null by a model without samples: it answers with `known`
  double scale = 1;           // from the units of the reading to those of the estimate
  // These three are in the units of the estimate. The first two replace those of the reading.
  std::optional<double> exact = {};
  std::optional<double> limit = {};
  std::optional<BoundedValue> known = {};  // empty if a model without samples has no such estimate

  std::optional<Estimate> Of(const BlockResult& merged) const;
};

// All estimates of a table that are known, or that the sample is large enough for.
std::vector<Estimate> EstimatesOf(const std::vector<Measurement>& table, const BlockResult& merged);

// The estimate in other units.
Estimate Scaled(Estimate estimate, double scale);

Estimate MeanOf(const Moments& sample, double events, double rounding = kRoundingOfAMean);
Estimate RatioOf(const BatchMeans& sample, double events);

// A remark for an estimate without a standard error, which needs this number of samples; infinite
// if no number is enough.
std::string RemarkOnSamples(absl::string_view estimate, double needed);

// Readings of the accumulator with this index. `rounding`: as of StatedError.
Reading MeanAt(size_t index, double events_per_sample = 1, double rounding = kRoundingOfAMean);
Reading RatioAt(size_t index, double events_per_sample = 1);

inline CurvePoint CurvePointOf(double at, const Estimate& estimate) {
  return {at, estimate.value, estimate.standard_error, estimate.batches, estimate.limit};
}

}  // namespace ballpiston
