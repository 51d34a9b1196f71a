#include "server/convert/result_record.h"

#include <cmath>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "server/convert/deterministic_bytes.h"

namespace ballpiston::server {
namespace {

bool Exists(const std::optional<double>& value) { return value && std::isfinite(*value); }

void SetModelError(const Answer& answer, bool first, storage::Estimate& record) {
  const std::optional<double> relative = answer.ModelErrorOf(record.name(), first);
  if (relative) record.set_model_error(*relative * std::fabs(record.value()));
}

void AddEstimate(const Estimate& estimate, const Answer& answer, bool first,
                 storage::Result& result) {
  if (!std::isfinite(estimate.value)) return;
  storage::Estimate* record = result.add_estimates();
  record->set_name(estimate.name);
  record->set_value(estimate.value);
  if (Exists(estimate.standard_error)) {
    record->set_standard_error(*estimate.standard_error);
    if (estimate.batches > 0) record->set_batches(estimate.batches);
  }
  if (Exists(estimate.exact)) record->set_exact(*estimate.exact);
  if (const auto z = estimate.ZScore(); Exists(z)) record->set_z_score(*z);
  if (Exists(estimate.noise_floor)) record->set_noise_floor(*estimate.noise_floor);
  if (Exists(estimate.limit)) record->set_limit(*estimate.limit);
  SetModelError(answer, first, *record);
}

void SetDivergence(const KlDivergence& divergence, storage::Result& result) {
  if (!std::isfinite(divergence.value)) return;
  storage::Divergence* record = result.mutable_divergence();
  record->set_value(divergence.value);
  record->set_noise_floor(divergence.noise_floor);
  record->set_cells(divergence.cells);
  record->set_noise_error(divergence.noise_error);
  record->set_standard_error(divergence.standard_error);
}

void AddHistogram(const NamedHistogram& histogram, storage::Details& details) {
  storage::Histogram* record = details.add_histograms();
  record->set_name(histogram.name);
  record->set_sigma(histogram.sigma);
  record->set_lower(histogram.histogram.lower);
  record->set_upper(histogram.histogram.upper);
  const std::vector<uint64_t>& counts = histogram.histogram.counts;
  record->mutable_counts()->Assign(counts.begin(), counts.end());
  if (histogram.time) record->set_time(*histogram.time);
}

void AddCurve(const Curve& curve, storage::Details& details) {
  storage::Curve* record = details.add_curves();
  record->set_name(curve.name);
  record->set_axis(curve.axis == CurveAxis::kPosition ? storage::Curve::POSITION
                                                      : storage::Curve::TIME);
  for (const CurvePoint& point : curve.points) {
    storage::Curve::Point* added = record->add_points();
    added->set_at(point.at);
    added->set_value(point.value);
    if (Exists(point.standard_error)) added->set_standard_error(*point.standard_error);
    if (Exists(point.limit)) added->set_limit(*point.limit);
  }
}

void SetHealth(const Health& health, storage::Result& result) {
  result.set_escapes(health.escapes);
  if (!std::isfinite(health.max_energy_error)) return;
  result.set_max_energy_error(health.max_energy_error);
}

// A remark stands for each estimate that has no value.
void AddRemarks(const PointSummary& summary, storage::Result& result) {
  result.mutable_remarks()->Assign(summary.remarks.begin(), summary.remarks.end());
  for (const Estimate& estimate : summary.estimates) {
    if (!std::isnan(estimate.value)) continue;
    result.add_remarks(absl::StrCat(estimate.name, " has no value: nothing was measured in ",
                                    summary.samples, " samples and ", summary.health.escapes,
                                    " orbits that left the cell"));
  }
}

storage::Result::Model RecordOf(Model model) {
  switch (model) {
    case Model::kAuto:
      return storage::Result::MODEL_UNSPECIFIED;
    case Model::kClosedForm:
      return storage::Result::CLOSED_FORM;
    case Model::kSpectrum:
      return storage::Result::SPECTRUM;
    case Model::kMarkov:
      return storage::Result::MARKOV;
    case Model::kBilliard:
      return storage::Result::BILLIARD;
    case Model::kBilliardReference:
      return storage::Result::BILLIARD_REFERENCE;
  }
  return storage::Result::MODEL_UNSPECIFIED;
}

}  // namespace

storage::Result ResultRecordOf(size_t index, const PointExperiment& experiment,
                               const PointSummary& summary) {
  storage::Result result;
  result.set_index(static_cast<int64_t>(index));
  for (const Parameter* parameter : kParameters) {
    const std::optional<double>& value = experiment.parameters().Find(*parameter);
    if (!value) continue;
    storage::Value* added = result.add_point();
    added->set_parameter(static_cast<uint32_t>(parameter->index));
    added->set_value(*value);
  }
  const Answer& answer = experiment.answer();
  result.set_model(RecordOf(answer.model));
  result.set_reason(answer.reason);
  result.set_samples(summary.samples);
  for (const Estimate& estimate : summary.estimates) {
    AddEstimate(estimate, answer, &estimate == &summary.estimates.front(), result);
  }
  if (summary.kl_divergence) SetDivergence(*summary.kl_divergence, result);
  SetHealth(summary.health, result);
  AddRemarks(summary, result);
  return result;
}

storage::Details DetailsRecordOf(const PointSummary& summary,
                                 const std::vector<uint64_t>& chunk_digests) {
  storage::Details details;
  for (const NamedHistogram& histogram : summary.histograms) AddHistogram(histogram, details);
  for (const Curve& curve : summary.curves) AddCurve(curve, details);
  details.mutable_chunk_digests()->Assign(chunk_digests.begin(), chunk_digests.end());
  return details;
}

Estimate FirstEstimateOf(const storage::Result& result) {
  Estimate first;
  if (result.estimates().empty()) return first;
  const storage::Estimate& record = result.estimates(0);
  first.value = record.value();
  if (record.has_standard_error()) first.standard_error = record.standard_error();
  return first;
}

std::string RecordBytes(const storage::Result& result) { return DeterministicBytes(result); }

std::string RecordBytes(const storage::Details& details) { return DeterministicBytes(details); }

absl::StatusOr<storage::Result> ResultFromBytes(const std::string& bytes) {
  storage::Result result;
  if (result.ParseFromString(bytes)) return result;
  return absl::DataLossError("a stored result cannot be read");
}

absl::StatusOr<storage::Details> DetailsFromBytes(const std::string& bytes) {
  storage::Details details;
  if (details.ParseFromString(bytes)) return details;
  return absl::DataLossError("the stored details of a result cannot be read");
}

}  // namespace ballpiston::server
