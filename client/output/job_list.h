// Prints jobs as a table, as {"jobs": [...]}, as one job per line, or as CSV. The table has a
// column for the principal if the jobs have different principals, a column for the priority if a
// priority is not 0, a column for the results if some results are pinned, have expired or will
// expire within a week, and a column for the labels if some job has one. CSV always has these
// columns.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "client/output/format.h"

namespace ballpiston::client {

// The table shows how long results are still kept, counted from `now`.
void PrintJobs(const std::vector<v1::EnsembleJob>& jobs, absl::Time now, Format format,
               std::ostream& out);

// KEY=VALUE, by key, with blanks between.
std::string LabelsText(const v1::EnsembleJob& job);

// The view to request: it includes the grids if the format shows them.
v1::ListEnsembleJobsRequest::View JobViewFor(Format format);

}  // namespace ballpiston::client
