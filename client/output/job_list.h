// Prints jobs: a table, {"jobs": [...]}, one job a line, or CSV. The table has a column for the
// principal if there is more than one, a column for the priority if any job has one other than 0,
// and a column for results if any are pinned, have expired or will expire within a week. CSV always
// has these columns.
#ifndef BALLPISTON_CLIENT_OUTPUT_JOB_LIST_H_
#define BALLPISTON_CLIENT_OUTPUT_JOB_LIST_H_

#include <ostream>
#include <vector>

#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "client/output/format.h"

namespace ballpiston::client {

// `now`: the table shows how long results are still kept.
void PrintJobs(const std::vector<v1::EnsembleJob>& jobs, absl::Time now, Format format,
               std::ostream& out);

// The view to request: with grids if the format shows them.
v1::ListEnsembleJobsRequest::View JobViewFor(Format format);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_JOB_LIST_H_
