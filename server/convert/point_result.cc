#include "server/convert/point_result.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "server/convert/compressed.h"
#include "server/convert/spec.h"

namespace ballpiston::server {
namespace {

bool Exists(const std::optional<double>& value) { return value && std::isfinite(*value); }

// Sets the error of a v1::Estimate or of a point of a curve.
template <typename Message>
void SetError(const std::optional<double>& error, uint64_t batches, Message& message) {
  if (!Exists(error)) return;
  message.set_standard_error(*error);
  if (batches > 0) message.set_batches(static_cast<double>(batches));
}

void AddEstimate(const Estimate& estimate, const Answer& answer, bool first,
                 v1::PointResult& result) {
  if (!std::isfinite(estimate.value)) return;
  v1::Estimate& message = *result.add_estimates();
  message.set_name(estimate.name);
  message.set_value(estimate.value);
  SetError(estimate.standard_error, estimate.batches, message);
  if (Exists(estimate.exact)) message.set_exact(*estimate.exact);
  if (const auto z = estimate.ZScore(); Exists(z)) message.set_z_score(*z);
  if (Exists(estimate.noise_floor)) message.set_noise_floor(*estimate.noise_floor);
  if (Exists(estimate.limit)) message.set_limit(*estimate.limit);
  const bool is_closed_form = !TakesSamples(answer.model) && estimate.exact == estimate.value;
  const std::optional<double> relative =
      is_closed_form ? 0 : answer.ModelErrorOf(estimate.name, first);
  if (relative) message.set_model_error(*relative * std::fabs(estimate.value));
}

void SetDivergence(const KlDivergence& divergence, v1::PointResult& result) {
  if (!std::isfinite(divergence.value)) return;
  v1::KlDivergence& message = *result.mutable_kl_divergence();
  message.set_value(divergence.value);
  message.set_noise_floor(divergence.noise_floor);
  message.set_cells(divergence.cells);
  message.set_noise_error(divergence.noise_error);
  message.set_standard_error(divergence.standard_error);
}

void AddHistogram(const NamedHistogram& histogram, v1::PointResult& details) {
  v1::Histogram& message = *details.add_histograms();
  message.set_name(histogram.name);
  message.set_sigma(histogram.sigma);
  message.set_lower(histogram.histogram.lower);
  message.set_upper(histogram.histogram.upper);
  const std::vector<uint64_t>& counts = histogram.histogram.counts;
  message.mutable_counts()->Assign(counts.begin(), counts.end());
  if (histogram.time) message.set_time(*histogram.time);
}

void AddCurve(const Curve& curve, v1::PointResult& details) {
  v1::Curve& message = *details.add_curves();
  message.set_name(curve.name);
  for (const CurvePoint& point : curve.points) {
    v1::Curve::Point& added = *message.add_points();
    if (curve.axis == CurveAxis::kPosition) {
      added.set_position(point.at);
    } else {
      added.set_time(point.at);
    }
    added.set_value(point.value);
    SetError(point.standard_error, point.batches, added);
    if (Exists(point.limit)) added.set_limit(*point.limit);
  }
}

void SetHealth(const Health& health, v1::PointResult& result) {
  v1::Health& message = *result.mutable_health();
  message.set_escapes(static_cast<double>(health.escapes));
  if (std::isfinite(health.max_energy_error)) message.set_max_energy_error(health.max_energy_error);
}

// Adds a remark for each estimate without a value, and one remark for all estimates whose model
// error is unknown.
void AddRemarks(const PointSummary& summary, v1::PointResult& result) {
  result.mutable_remarks()->Assign(summary.remarks.begin(), summary.remarks.end());
  for (const Estimate& estimate : summary.estimates) {
    if (!std::isnan(estimate.value)) continue;
    result.add_remarks(absl::StrCat(estimate.name, " has no value: nothing was measured in ",
                                    summary.samples, " samples and ", summary.health.escapes,
                                    " orbits that left the cell"));
  }
  std::vector<std::string> unknown;
  for (const v1::Estimate& estimate : result.estimates()) {
    if (!estimate.has_model_error()) unknown.push_back(estimate.name());
  }
  if (unknown.empty()) return;
  result.add_remarks(
      absl::StrCat("no bound of the model error is known for ", absl::StrJoin(unknown, ", ")));
}

// A damaged record may lack a parameter.
bool HasNeeded(const PointParameters& point, const ExperimentKind& experiment) {
  return std::ranges::all_of(experiment.parameters, [&](const ParameterUse& use) {
    return !use.needed || point.Find(*use.parameter);
  });
}

}  // namespace

v1::PointResult ResultOf(size_t index, const PointExperiment& experiment,
                         const PointSummary& summary) {
  const Answer& answer = experiment.answer();
  v1::PointResult result;
  result.set_index(static_cast<int32_t>(index));
  *result.mutable_parameters() = ParametersMessage(experiment.parameters());
  result.set_model(ModelMessage(answer.model));
  result.set_reason(answer.reason);
  result.set_samples(static_cast<double>(summary.samples));
  for (const Estimate& estimate : summary.estimates) {
    AddEstimate(estimate, answer, &estimate == &summary.estimates.front(), result);
  }
  if (summary.kl_divergence) SetDivergence(*summary.kl_divergence, result);
  SetHealth(summary.health, result);
  AddRemarks(summary, result);
  return result;
}

v1::PointResult DetailsOf(const PointSummary& summary) {
  v1::PointResult details;
  for (const NamedHistogram& histogram : summary.histograms) AddHistogram(histogram, details);
  for (const Curve& curve : summary.curves) AddCurve(curve, details);
  return details;
}

v1::PointResult WithDetails(v1::PointResult result, const v1::PointResult& details,
                            const ExperimentKind& experiment) {
  result.MergeFrom(details);
  if (result.histograms().empty() || experiment.expected_probabilities == nullptr) return result;
  const PointParameters point = ParametersOf(result.parameters());
  if (!HasNeeded(point, experiment)) return result;
  const auto expected = experiment.expected_probabilities(point);
  for (int i = 0; i < std::min(result.histograms_size(), static_cast<int>(expected.size())); ++i) {
    const std::vector<double>& bins = expected[static_cast<size_t>(i)];
    result.mutable_histograms(i)->mutable_expected_probabilities()->Assign(bins.begin(),
                                                                           bins.end());
  }
  return result;
}

Estimate FirstEstimateOf(const v1::PointResult& result) {
  Estimate first;
  if (result.estimates().empty()) return first;
  const v1::Estimate& message = result.estimates(0);
  first.value = message.value();
  if (message.has_standard_error()) first.standard_error = message.standard_error();
  return first;
}

absl::StatusOr<v1::PointResult> ResultFromBytes(const std::string& bytes) {
  v1::PointResult result;
  if (result.ParseFromString(bytes)) return result;
  return absl::DataLossError("a stored result cannot be read");
}

std::string DetailsBytes(const v1::PointResult& details) {
  const std::string plain = details.SerializeAsString();
  return plain.empty() ? "" : Compressed(plain);
}

absl::StatusOr<v1::PointResult> DetailsFromBytes(const std::string& bytes) {
  v1::PointResult details;
  if (bytes.empty()) return details;
  const std::optional<std::string> plain = Uncompressed(bytes);
  if (plain && details.ParseFromString(*plain)) return details;
  return absl::DataLossError("the stored details of a result cannot be read");
}

}  // namespace ballpiston::server
