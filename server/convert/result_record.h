// A point's results, from the core's numbers to the store's record: equal numbers give equal bytes.
// A value that is not finite is left out. Pure functions.
#ifndef BALLPISTON_SERVER_CONVERT_RESULT_RECORD_H_
#define BALLPISTON_SERVER_CONVERT_RESULT_RECORD_H_

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "ballpiston/storage/records.pb.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston::server {

// Histograms and curves: what is left out of BASIC views.
enum class Details { kLeftOut, kIncluded };

// Requires at least one merged block, if the experiment has any.
storage::Result ResultRecordOf(size_t index, const PointExperiment& experiment,
                               const BlockResult& merged, Details details);

void ClearDetails(storage::Result& result);

// Value and standard error of the first estimate; of a result without one, 0 and none.
Estimate FirstEstimateOf(const storage::Result& result);

std::string ResultRecordBytes(const storage::Result& result);
absl::StatusOr<storage::Result> ResultFromBytes(const std::string& bytes);  // DATA_LOSS

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_CONVERT_RESULT_RECORD_H_
