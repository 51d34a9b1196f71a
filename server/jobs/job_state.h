// The states of a job and the permitted transitions.
//
//   QUEUED -> RUNNING -> SUCCEEDED | FAILED
//   QUEUED, RUNNING -> CANCELLING -> CANCELLED
//
// QUEUED may also end at once: SUCCEEDED after a restart that found nothing left to compute, or
// FAILED. Pure functions.
#ifndef BALLPISTON_SERVER_JOBS_JOB_STATE_H_
#define BALLPISTON_SERVER_JOBS_JOB_STATE_H_

#include <string>

#include "server/store/job_record.h"

namespace ballpiston::server {

bool HasEnded(JobState state);
bool MayFollow(JobState from, JobState to);
std::string StateName(JobState state);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_JOBS_JOB_STATE_H_
