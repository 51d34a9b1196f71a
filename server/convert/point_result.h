// Converts a point's results from the core's numbers to the API's PointResult, which the store
// keeps in two parts. Equal numbers give equal messages. A value that is not finite is left out.
// Pure functions.
#pragma once

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "ballpiston/v1/result.pb.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston::server {

// Without the details. Requires at least one merged block in the summary, if the experiment has
// any.
v1::PointResult ResultOf(size_t index, const PointExperiment& experiment,
                         const PointSummary& summary);

// The details: histograms and curves. The expected probabilities of the histograms are left out,
// because they follow from the point's parameters.
v1::PointResult DetailsOf(const PointSummary& summary);

// Result and details as clients see them. `experiment`: of the result's job.
v1::PointResult WithDetails(v1::PointResult result, const v1::PointResult& details,
                            const ExperimentKind& experiment);

// Value and standard error of the first estimate. Without an estimate, the value is 0 and the error
// is empty.
Estimate FirstEstimateOf(const v1::PointResult& result);

// A stored result. DATA_LOSS if it cannot be read.
absl::StatusOr<v1::PointResult> ResultFromBytes(const std::string& bytes);

// The stored details: compressed, because the counts of histograms take eight bytes each and are
// small. Empty if there are none.
std::string DetailsBytes(const v1::PointResult& details);
absl::StatusOr<v1::PointResult> DetailsFromBytes(const std::string& bytes);  // DATA_LOSS

}  // namespace ballpiston::server
