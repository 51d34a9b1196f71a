// The closed forms, as AnalyticService gives them. Pure functions.
#ifndef BALLPISTON_SERVER_CONVERT_ANALYTIC_H_
#define BALLPISTON_SERVER_CONVERT_ANALYTIC_H_

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "ballpiston/v1/analytic.pb.h"

namespace ballpiston::server {

inline constexpr int64_t kMaxPairs = 10'000;
// Numbers that depend on an energy or a temperature, over all pairs; some 1 MB of answer.
inline constexpr int64_t kMaxAnalyticValues = 100'000;

// INVALID_ARGUMENT with every violation: the values outside of their domain, or, if there are none,
// the limits on the answer's size.
absl::StatusOr<v1::EvaluatePairsResponse> EvaluatePairs(const v1::EvaluatePairsRequest& request);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_CONVERT_ANALYTIC_H_
