#include "server/convert/point_result.h"

#include <cmath>
#include <optional>

#include "absl/status/status.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/spec.h"

namespace ballpiston::server {
namespace {

bool Exists(const std::optional<double>& value) { return value && std::isfinite(*value); }

void AddEstimate(const Estimate& estimate, v1::PointResult& result) {
  if (!std::isfinite(estimate.value)) return;
  v1::Estimate* message = result.add_estimates();
  message->set_name(estimate.name);
  message->set_value(estimate.value);
  if (Exists(estimate.standard_error)) message->set_standard_error(*estimate.standard_error);
  if (Exists(estimate.exact)) message->set_exact(*estimate.exact);
  if (const auto z = estimate.ZScore(); Exists(z)) message->set_z_score(*z);
}

void SetDivergence(const KlDivergence& divergence, v1::PointResult& result) {
  if (!std::isfinite(divergence.value)) return;
  v1::KlDivergence* message = result.mutable_kl_divergence();
  message->set_value(divergence.value);
  message->set_noise_floor(divergence.noise_floor);
  message->set_cells(divergence.cells);
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

void SetHealth(const Health& health, v1::PointResult& result) {
  result.mutable_health()->set_escapes(static_cast<double>(health.escapes));
  if (!std::isfinite(health.max_energy_error)) return;
  result.mutable_health()->set_max_energy_error(health.max_energy_error);
}

}  // namespace

v1::PointResult PointResultOf(size_t index, const PointExperiment& experiment,
                              const BlockResult& merged, Histograms histograms) {
  const PointSummary summary = experiment.Summarize(merged);
  v1::PointResult result;
  result.set_index(static_cast<int32_t>(index));
  *result.mutable_parameters() = ParametersMessage(experiment.parameters());
  result.set_model(ModelMessage(experiment.model()));
  result.set_samples(static_cast<double>(summary.samples));
  for (const Estimate& estimate : summary.estimates) AddEstimate(estimate, result);
  if (summary.kl_divergence) SetDivergence(*summary.kl_divergence, result);
  if (histograms == Histograms::kIncluded) {
    for (const SignedHistogram& histogram : summary.histograms) AddHistogram(histogram, result);
  }
  SetHealth(summary.health, result);
  return result;
}

std::string PointResultBytes(const v1::PointResult& result) { return DeterministicBytes(result); }

absl::StatusOr<v1::PointResult> PointResultFromBytes(const std::string& bytes) {
  v1::PointResult result;
  if (result.ParseFromString(bytes)) return result;
  return absl::DataLossError("a stored result cannot be read");
}

}  // namespace ballpiston::server
