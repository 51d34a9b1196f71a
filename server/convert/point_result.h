// What the core measured at a point, as the API's PointResult: the same bytes for the same numbers.
// A value that is not finite does not exist for JSON and is left out. Pure functions.
#ifndef BALLPISTON_SERVER_CONVERT_POINT_RESULT_H_
#define BALLPISTON_SERVER_CONVERT_POINT_RESULT_H_

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "ballpiston/v1/result.pb.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston::server {

// Histograms and curves: what is left out of BASIC views.
enum class Details { kLeftOut, kIncluded };

// Requires at least one merged block, if the experiment has any.
v1::PointResult PointResultOf(size_t index, const PointExperiment& experiment,
                              const BlockResult& merged, Details details);

void ClearDetails(v1::PointResult& result);

// Value and standard error of the first estimate; of a result without one, 0 and none.
Estimate FirstEstimateOf(const v1::PointResult& result);

std::string PointResultBytes(const v1::PointResult& result);
absl::StatusOr<v1::PointResult> PointResultFromBytes(const std::string& bytes);  // DATA_LOSS

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_CONVERT_POINT_RESULT_H_
