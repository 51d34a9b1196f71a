// The log lines about a job's life, after its acceptance (api/create_ensemble_job.cc).
#pragma once

#include <string>

#include "ballpiston/v1/spec.pb.h"
#include "server/jobs/job.h"
#include "server/store/job_record.h"

namespace ballpiston::server {

// The job entered this state, which is not the last one.
void LogState(const Job& job, JobState state);

void LogEnd(const JobRecord& ended);

// The engine crashed, and the job fails. `points`: those that were being computed, if known.
void LogCrashed(const JobRecord& job, const std::string& points, const v1::EnsembleSpec& spec);

}  // namespace ballpiston::server
