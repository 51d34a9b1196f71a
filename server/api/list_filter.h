// Reads the filters of a ListEnsembleJobsRequest.
#pragma once

#include "ballpiston/v1/ensemble.pb.h"
#include "server/api/request_check.h"
#include "server/jobs/job_list.h"

namespace ballpiston::server {

// Adds violations to `check`: a state or experiment that is unspecified or unknown, and a time that
// is not a valid google.protobuf.Timestamp (years 1 to 9999). At most 100 violations of each list.
JobFilter ReadListFilter(const v1::ListEnsembleJobsRequest& request, RequestCheck& check);

}  // namespace ballpiston::server
