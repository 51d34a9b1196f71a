// The states of a job; store/job_table.h has the transitions. Pure functions.
#ifndef BALLPISTON_SERVER_JOBS_JOB_STATE_H_
#define BALLPISTON_SERVER_JOBS_JOB_STATE_H_

#include <string>

#include "server/store/job_record.h"

namespace ballpiston::server {

bool HasEnded(JobState state);
std::string StateName(JobState state);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_JOBS_JOB_STATE_H_
