// Watching a job to its end from the terminal: progress on standard error, Ctrl-C as promised.
//
// The first Ctrl-C tells how to watch the job again; a second one within five seconds cancels the
// job; without one the client lets go and the job goes on. A job that ends meanwhile has ended.
#ifndef BALLPISTON_CLIENT_COMMAND_FOLLOW_JOB_H_
#define BALLPISTON_CLIENT_COMMAND_FOLLOW_JOB_H_

#include <optional>
#include <ostream>
#include <string>

#include "absl/status/statusor.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "client/command/connection.h"
#include "client/command/interrupts.h"
#include "client/output/progress_reporter.h"

namespace ballpiston::client {

// The job as it ended, or nothing if the user pressed Ctrl-C. UNAVAILABLE if the server stayed away
// for too long.
absl::StatusOr<std::optional<v1::EnsembleJob>> FollowJob(const Connection& connection,
                                                         const std::string& name,
                                                         ProgressStyle style,
                                                         Interrupts& interrupts, std::ostream& err);

// kDone for a job that succeeded, else kFailed, with the reason on `err`.
ExitCode ReportEnd(const v1::EnsembleJob& job, std::ostream& err);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_FOLLOW_JOB_H_
