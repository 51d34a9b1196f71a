// The log lines about a job's life, after its acceptance (api/create_ensemble_job.cc).
#pragma once

#include "server/store/job_record.h"

namespace ballpiston::server {

// The job entered this state, which is not the last one.
void LogState(const JobRecord& job, JobState state);

// A job that fails because the engine crashes is logged with its question.
void LogEnd(const JobRecord& ended);

}  // namespace ballpiston::server
