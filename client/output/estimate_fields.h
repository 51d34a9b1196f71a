// The optional fields of an estimate.
#pragma once

#include <optional>

#include "ballpiston/v1/result.pb.h"

namespace ballpiston::client {

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
