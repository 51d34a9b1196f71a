#include "core/ensemble/measurement.h"

#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace ballpiston {
namespace {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

double EventsIn(const BlockResult& merged, double events_per_sample) {
  return events_per_sample * static_cast<double>(merged.samples);
}

}  // namespace

Estimate Scaled(Estimate estimate, double scale) {
  estimate.value *= scale;
  if (estimate.standard_error) *estimate.standard_error *= std::fabs(scale);
  if (estimate.exact) *estimate.exact *= scale;
  if (estimate.limit) *estimate.limit *= scale;
  return estimate;
}

std::optional<Estimate> Measurement::Of(const BlockResult& merged) const {
  std::optional<Estimate> estimate;
  if (reading != nullptr) {
    estimate = reading(merged);
    if (estimate) estimate = Scaled(*std::move(estimate), scale);
  } else if (known) {
    estimate = {.value = known->value, .standard_error = known->error};
  }
  if (!estimate) return std::nullopt;
  estimate->name = name;
  if (exact) estimate->exact = exact;
  if (limit) estimate->limit = limit;
  return estimate;
}

std::vector<Estimate> EstimatesOf(const std::vector<Measurement>& table,
                                  const BlockResult& merged) {
  std::vector<Estimate> estimates;
  for (const Measurement& row : table) {
    if (auto estimate = row.Of(merged)) estimates.push_back(*std::move(estimate));
  }
  return estimates;
}

Estimate MeanOf(const Moments& sample, double events, double rounding) {
  const double value = sample.count == 0 ? kNotMeasured : sample.mean;
  return {.value = value,
          .standard_error = StatedError(events, value, sample.StandardError(), rounding),
          .batches = sample.EffectiveCount()};
}

Estimate RatioOf(const BatchMeans& sample, double events) {
  const double value = sample.Ratio().value_or(kNotMeasured);
  return {.value = value,
          .standard_error = StatedError(events, value, sample.StandardError()),
          .batches = sample.EffectiveCount()};
}

std::string RemarkOnSamples(absl::string_view estimate, double needed) {
  if (!std::isfinite(needed)) {
    return absl::StrCat(estimate, " has no standard error: no number of samples has enough of the ",
                        "events that determine the mean");
  }
  return absl::StrFormat(
      "%s has no standard error: an error needs about %.6g samples; fewer have too few of the "
      "events that determine the mean",
      estimate, std::ceil(needed));
}

Reading MeanAt(size_t index, double events_per_sample, double rounding) {
  return [=](const BlockResult& merged) {
    return MeanOf(merged.moments[index], EventsIn(merged, events_per_sample), rounding);
  };
}

Reading RatioAt(size_t index, double events_per_sample) {
  return [=](const BlockResult& merged) {
    return RatioOf(merged.batch_means[index], EventsIn(merged, events_per_sample));
  };
}

}  // namespace ballpiston
