// Prints jobs: a table, {"jobs": [...]}, one job a line, or CSV.
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
