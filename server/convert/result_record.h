// Converts a point's results from the core's numbers to the store's record. Equal numbers give
// equal bytes. A value that is not finite is left out. Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "ballpiston/storage/records.pb.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston::server {

// Without the details. Requires at least one merged block in the summary, if the experiment has
// any.
storage::Result ResultRecordOf(size_t index, const PointExperiment& experiment,
                               const PointSummary& summary);

// Histograms and curves, and the digests of the chunks that they are made of.
storage::Details DetailsRecordOf(const PointSummary& summary,
                                 const std::vector<uint64_t>& chunk_digests = {});

// Value and standard error of the first estimate. Without an estimate, the value is 0 and the error
// is empty.
Estimate FirstEstimateOf(const storage::Result& result);

std::string RecordBytes(const storage::Result& result);
std::string RecordBytes(const storage::Details& details);  // empty if there are none
absl::StatusOr<storage::Result> ResultFromBytes(const std::string& bytes);    // DATA_LOSS
absl::StatusOr<storage::Details> DetailsFromBytes(const std::string& bytes);  // DATA_LOSS

}  // namespace ballpiston::server
