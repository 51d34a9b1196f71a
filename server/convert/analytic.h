// Evaluates the closed forms for AnalyticService. Pure functions.
#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "ballpiston/v1/analytic.pb.h"

namespace ballpiston::server {

inline constexpr int64_t kMaxPairs = 10'000;
// Limit of the values that depend on an energy or a temperature, over all pairs. So many values
// take some 1 MB of the answer.
inline constexpr int64_t kMaxAnalyticValues = 100'000;

// INVALID_ARGUMENT with every violation: values outside of their domain or, if all values are
// valid, an answer larger than the limits.
absl::StatusOr<v1::EvaluatePairsResponse> EvaluatePairs(const v1::EvaluatePairsRequest& request);

}  // namespace ballpiston::server
