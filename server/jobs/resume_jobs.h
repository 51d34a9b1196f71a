// Resumes the unfinished jobs of an earlier process.
//
// Finished points stay, and unfinished points resume from their checkpoints. A job of another
// engine version is computed again. A job ends at once if it was being cancelled, if it cannot be
// read, or if the engine crashed too often while it was computed (scheduling/crash_record.h).
#pragma once

#include "absl/status/status.h"
#include "server/jobs/active_jobs.h"
#include "server/scheduling/crash_record.h"
#include "server/store/store.h"

namespace ballpiston::server {

// Returns when all changes of the jobs' states are on disk. `crashes` must outlive the runs.
absl::Status ResumeJobs(Store& store, CrashRecord& crashes, ActiveJobs& jobs);

}  // namespace ballpiston::server
