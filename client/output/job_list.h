// Prints jobs: a table, {"jobs": [...]}, one job a line, or CSV. The table has a column for whose a
// job is if there is more than one principal, one for priorities if there is any but 0, and one for
// results that are pinned, have expired or will expire within a week, if there are any; CSV has
// them always.
#ifndef BALLPISTON_CLIENT_OUTPUT_JOB_LIST_H_
#define BALLPISTON_CLIENT_OUTPUT_JOB_LIST_H_

#include <ostream>
#include <vector>

#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "client/output/format.h"

namespace ballpiston::client {

// `now` is for how long results are still kept.
void PrintJobs(const std::vector<v1::EnsembleJob>& jobs, absl::Time now, Format format,
               std::ostream& out);

// What has to be fetched: with grids where the format shows them.
v1::ListEnsembleJobsRequest::View JobViewFor(Format format);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_JOB_LIST_H_
