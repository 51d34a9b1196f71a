#include "server/convert/point_result.h"

#include <algorithm>
#include <vector>

#include "core/ensemble/parameter.h"
#include "server/convert/spec.h"

namespace ballpiston::server {
namespace {

PointParameters PointOf(const storage::Result& record) {
  PointParameters point;
  for (const storage::Value& value : record.point()) {
    if (value.parameter() >= kParameters.size()) continue;
    point.Set(*kParameters[value.parameter()], value.value());
  }
  return point;
}

v1::EnsembleSpec::Model MessageOf(storage::Result::Model model) {
  switch (model) {
    case storage::Result::CLOSED_FORM:
      return v1::EnsembleSpec::CLOSED_FORM;
    case storage::Result::SPECTRUM:
      return v1::EnsembleSpec::SPECTRUM;
    case storage::Result::MARKOV:
      return v1::EnsembleSpec::MARKOV;
    case storage::Result::BILLIARD:
      return v1::EnsembleSpec::BILLIARD;
    case storage::Result::BILLIARD_REFERENCE:
      return v1::EnsembleSpec::BILLIARD_REFERENCE;
    default:
      return v1::EnsembleSpec::MODEL_UNSPECIFIED;
  }
}

void Fill(const storage::Estimate& record, v1::Estimate& message) {
  message.set_name(record.name());
  message.set_value(record.value());
  if (record.has_standard_error()) message.set_standard_error(record.standard_error());
  if (record.has_exact()) message.set_exact(record.exact());
  if (record.has_z_score()) message.set_z_score(record.z_score());
  if (record.has_model_error()) message.set_model_error(record.model_error());
  if (record.has_noise_floor()) message.set_noise_floor(record.noise_floor());
  if (record.has_limit()) message.set_limit(record.limit());
  if (record.has_batches()) message.set_batches(static_cast<double>(record.batches()));
}

void Fill(const storage::Divergence& record, v1::KlDivergence& message) {
  message.set_value(record.value());
  message.set_noise_floor(record.noise_floor());
  message.set_cells(record.cells());
  message.set_noise_error(record.noise_error());
  message.set_standard_error(record.standard_error());
}

void Fill(const storage::Histogram& record, v1::Histogram& message) {
  message.set_name(record.name());
  message.set_sigma(record.sigma());
  message.set_lower(record.lower());
  message.set_upper(record.upper());
  message.mutable_counts()->Assign(record.counts().begin(), record.counts().end());
  if (record.has_time()) message.set_time(record.time());
}

void Fill(const storage::Curve& record, v1::Curve& message) {
  message.set_name(record.name());
  for (const storage::Curve::Point& point : record.points()) {
    v1::Curve::Point* added = message.add_points();
    if (record.axis() == storage::Curve::POSITION) {
      added->set_position(point.at());
    } else {
      added->set_time(point.at());
    }
    added->set_value(point.value());
    if (point.has_standard_error()) added->set_standard_error(point.standard_error());
    if (point.has_limit()) added->set_limit(point.limit());
  }
}

}  // namespace

v1::PointResult PointResultMessage(const storage::Result& record) {
  v1::PointResult message;
  message.set_index(static_cast<int32_t>(record.index()));
  *message.mutable_parameters() = ParametersMessage(PointOf(record));
  message.set_model(MessageOf(record.model()));
  message.set_reason(record.reason());
  message.set_samples(static_cast<double>(record.samples()));
  for (const auto& estimate : record.estimates()) Fill(estimate, *message.add_estimates());
  if (record.has_divergence()) Fill(record.divergence(), *message.mutable_kl_divergence());
  message.mutable_health()->set_escapes(static_cast<double>(record.escapes()));
  if (record.has_max_energy_error()) {
    message.mutable_health()->set_max_energy_error(record.max_energy_error());
  }
  *message.mutable_remarks() = record.remarks();
  return message;
}

v1::PointResult PointResultMessage(const storage::Result& record, const storage::Details& details,
                                   const ExperimentKind& experiment) {
  v1::PointResult message = PointResultMessage(record);
  for (const auto& curve : details.curves()) Fill(curve, *message.add_curves());
  for (const auto& histogram : details.histograms()) Fill(histogram, *message.add_histograms());
  *message.mutable_chunk_digests() = details.chunk_digests();
  if (details.histograms().empty() || experiment.expected_probabilities == nullptr) return message;
  const PointParameters point = PointOf(record);
  const auto is_missing = [&](const ParameterUse& use) {
    return use.needed && !point.Find(*use.parameter);
  };
  if (std::ranges::any_of(experiment.parameters, is_missing)) return message;  // a damaged record
  const auto expected = experiment.expected_probabilities(point);
  for (int i = 0; i < std::min(message.histograms_size(), static_cast<int>(expected.size())); ++i) {
    const std::vector<double>& bins = expected[static_cast<size_t>(i)];
    message.mutable_histograms(i)->mutable_expected_probabilities()->Assign(bins.begin(),
                                                                            bins.end());
  }
  return message;
}

}  // namespace ballpiston::server
