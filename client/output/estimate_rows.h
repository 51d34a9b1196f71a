// The estimates of a point as rows of a table, and the optional fields of a row.
#pragma once

#include <optional>
#include <vector>

#include "ballpiston/v1/result.pb.h"

namespace ballpiston::client {

// The estimates in their order, then the divergence and its noise floor if the point has them.
inline std::vector<v1::Estimate> EstimatesOf(const v1::PointResult& point) {
  std::vector<v1::Estimate> rows(point.estimates().begin(), point.estimates().end());
  if (!point.has_kl_divergence()) return rows;
  const v1::KlDivergence& kl = point.kl_divergence();
  const auto add = [&rows](const char* name, double value, double error) {
    rows.emplace_back().set_name(name);
    rows.back().set_value(value);
    rows.back().set_standard_error(error);
  };
  add("kl_divergence", kl.value(), kl.standard_error());
  add("kl_noise_floor", kl.noise_floor(), kl.noise_error());
  return rows;
}

// An optional field of an estimate.
struct Field {
  bool (v1::Estimate::*is_there)() const;
  double (v1::Estimate::*value)() const;

  std::optional<double> Of(const v1::Estimate& estimate) const {
    if (!(estimate.*is_there)()) return std::nullopt;
    return (estimate.*value)();
  }
};

inline constexpr Field kError = {&v1::Estimate::has_standard_error, &v1::Estimate::standard_error};
inline constexpr Field kExact = {&v1::Estimate::has_exact, &v1::Estimate::exact};
inline constexpr Field kZScore = {&v1::Estimate::has_z_score, &v1::Estimate::z_score};
inline constexpr Field kModelError = {&v1::Estimate::has_model_error, &v1::Estimate::model_error};
inline constexpr Field kNoiseFloor = {&v1::Estimate::has_noise_floor, &v1::Estimate::noise_floor};
inline constexpr Field kLimit = {&v1::Estimate::has_limit, &v1::Estimate::limit};
inline constexpr Field kBatches = {&v1::Estimate::has_batches, &v1::Estimate::batches};

}  // namespace ballpiston::client
