#include "client/output/result_row.h"

namespace ballpiston::client {
namespace {

ResultRow RowOf(const v1::Estimate& estimate) {
  ResultRow row(estimate.name(), estimate.value());
  if (estimate.has_standard_error()) row.standard_error = estimate.standard_error();
  if (estimate.has_exact()) row.exact = estimate.exact();
  if (estimate.has_z_score()) row.z_score = estimate.z_score();
  if (estimate.has_model_error()) row.model_error = estimate.model_error();
  if (estimate.has_noise_floor()) row.noise_floor = estimate.noise_floor();
  if (estimate.has_limit()) row.limit = estimate.limit();
  return row;
}

}  // namespace

std::vector<ResultRow> ResultRows(const v1::PointResult& point) {
  std::vector<ResultRow> rows;
  for (const v1::Estimate& estimate : point.estimates()) rows.push_back(RowOf(estimate));
  if (point.has_kl_divergence()) {
    const v1::KlDivergence& kl = point.kl_divergence();
    rows.emplace_back("kl_divergence", kl.value()).standard_error = kl.standard_error();
    rows.emplace_back("kl_noise_floor", kl.noise_floor()).standard_error = kl.noise_error();
  }
  return rows;
}

}  // namespace ballpiston::client
