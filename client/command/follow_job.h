// Watching a job to its end from the terminal, with progress on standard error.
//
// An interruption (interrupts.h) ends the watch, but not the job. The message says how to watch the
// job again and how to cancel it.
#ifndef BALLPISTON_CLIENT_COMMAND_FOLLOW_JOB_H_
#define BALLPISTON_CLIENT_COMMAND_FOLLOW_JOB_H_

#include <string>

#include "absl/status/statusor.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "client/command/connection.h"
#include "client/command/options.h"
#include "client/command/terminal.h"
#include "client/output/progress_reporter.h"

namespace ballpiston::client {

// The style of --progress. With --quiet and without --progress: none.
ProgressStyle StyleOf(const Options& options);

// The job as it ended. UNAVAILABLE if the server stayed away for too long.
absl::StatusOr<v1::EnsembleJob> FollowJob(const Connection& connection, const std::string& name,
                                          ProgressStyle style, const Terminal& terminal);

// kDone for a job that succeeded, else kFailed, with the reason on standard error.
ExitCode ReportEnd(const v1::EnsembleJob& job, const Terminal& terminal);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_FOLLOW_JOB_H_
