// Prints jobs: a table, {"jobs": [...]}, one job a line, or CSV. The table has a column for whose a
// job is if there is more than one principal, and one for priorities if there is any but 0; CSV has
// them always.
#ifndef BALLPISTON_CLIENT_OUTPUT_JOB_LIST_H_
#define BALLPISTON_CLIENT_OUTPUT_JOB_LIST_H_

#include <ostream>
#include <vector>

#include "ballpiston/v1/ensemble.pb.h"
#include "client/output/format.h"

namespace ballpiston::client {

void PrintJobs(const std::vector<v1::EnsembleJob>& jobs, Format format, std::ostream& out);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_JOB_LIST_H_
