#include "server/convert/point_result.h"

#include <cmath>
#include <optional>

#include "absl/status/status.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/spec.h"

namespace ballpiston::server {
namespace {

bool Exists(const std::optional<double>& value) { return value && std::isfinite(*value); }

// Relative to the first estimate; of the others nothing is known but where it is 0.
void SetModelError(const Answer& answer, bool first, v1::Estimate& message) {
  if (!answer.model_error || (!first && *answer.model_error != 0)) return;
  message.set_model_error(*answer.model_error * std::fabs(message.value()));
}

void AddEstimate(const Estimate& estimate, const Answer& answer, bool first,
                 v1::PointResult& result) {
  if (!std::isfinite(estimate.value)) return;
  v1::Estimate* message = result.add_estimates();
  message->set_name(estimate.name);
  message->set_value(estimate.value);
  if (Exists(estimate.standard_error)) message->set_standard_error(*estimate.standard_error);
  if (Exists(estimate.exact)) message->set_exact(*estimate.exact);
  if (const auto z = estimate.ZScore(); Exists(z)) message->set_z_score(*z);
  if (Exists(estimate.noise_floor)) message->set_noise_floor(*estimate.noise_floor);
  if (Exists(estimate.limit)) message->set_limit(*estimate.limit);
  SetModelError(answer, first, *message);
}

void SetDivergence(const KlDivergence& divergence, v1::PointResult& result) {
  if (!std::isfinite(divergence.value)) return;
  v1::KlDivergence* message = result.mutable_kl_divergence();
  message->set_value(divergence.value);
  message->set_noise_floor(divergence.noise_floor);
  message->set_cells(divergence.cells);
  message->set_noise_error(divergence.noise_error);
  message->set_standard_error(divergence.standard_error);
}

void AddHistogram(const SignedHistogram& histogram, v1::PointResult& result) {
  v1::Histogram* message = result.add_histograms();
  message->set_name(histogram.name);
  message->set_sigma(histogram.sigma);
  message->set_lower(histogram.histogram.lower);
  message->set_upper(histogram.histogram.upper);
  for (const uint64_t count : histogram.histogram.counts) {
    message->add_counts(static_cast<double>(count));
  }
  message->mutable_expected_probabilities()->Assign(histogram.expected_probabilities.begin(),
                                                    histogram.expected_probabilities.end());
}

void AddCurve(const Curve& curve, v1::PointResult& result) {
  v1::Curve* message = result.add_curves();
  message->set_name(curve.name);
  for (const CurvePoint& point : curve.points) {
    v1::Curve::Point* added = message->add_points();
    added->set_time(point.time);
    added->set_value(point.value);
    if (Exists(point.standard_error)) added->set_standard_error(*point.standard_error);
    if (Exists(point.limit)) added->set_limit(*point.limit);
  }
}

void SetHealth(const Health& health, v1::PointResult& result) {
  result.mutable_health()->set_escapes(static_cast<double>(health.escapes));
  if (!std::isfinite(health.max_energy_error)) return;
  result.mutable_health()->set_max_energy_error(health.max_energy_error);
}

}  // namespace

v1::PointResult PointResultOf(size_t index, const PointExperiment& experiment,
                              const BlockResult& merged, Details details) {
  const PointSummary summary = experiment.Summarize(merged);
  v1::PointResult result;
  result.set_index(static_cast<int32_t>(index));
  *result.mutable_parameters() = ParametersMessage(experiment.parameters());
  const Answer& answer = experiment.answer();
  result.set_model(ModelMessage(answer.model));
  result.set_reason(answer.reason);
  result.set_samples(static_cast<double>(summary.samples));
  for (const Estimate& estimate : summary.estimates) {
    AddEstimate(estimate, answer, &estimate == &summary.estimates.front(), result);
  }
  if (summary.kl_divergence) SetDivergence(*summary.kl_divergence, result);
  if (details == Details::kIncluded) {
    for (const SignedHistogram& histogram : summary.histograms) AddHistogram(histogram, result);
    for (const Curve& curve : summary.curves) AddCurve(curve, result);
  }
  SetHealth(summary.health, result);
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

void ClearDetails(v1::PointResult& result) {
  result.clear_histograms();
  result.clear_curves();
}

std::string PointResultBytes(const v1::PointResult& result) { return DeterministicBytes(result); }

absl::StatusOr<v1::PointResult> PointResultFromBytes(const std::string& bytes) {
  v1::PointResult result;
  if (result.ParseFromString(bytes)) return result;
  return absl::DataLossError("a stored result cannot be read");
}

}  // namespace ballpiston::server
