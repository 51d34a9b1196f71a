// Watches a job to its end from the terminal, with progress on standard error.
//
// An interruption (interrupts.h) or an error ends the watch, but not the job. The message says how
// to watch the job again and how to cancel it.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "client/command/connection.h"
#include "client/command/options.h"
#include "client/command/terminal.h"
#include "client/output/progress.h"

namespace ballpiston::client {

// The style of --progress. With --quiet none, unless the command line has --progress.
ProgressStyle StyleOf(const Options& options);

// Returns the ended job. UNAVAILABLE if the server did not answer for too long.
absl::StatusOr<v1::EnsembleJob> FollowJob(const Connection& connection, const std::string& name,
                                          ProgressStyle style, const Terminal& terminal);

// Returns kDone for a job that succeeded. Else prints the reason on standard error and returns
// kFailed.
ExitCode ReportEnd(const v1::EnsembleJob& job, const Terminal& terminal);

}  // namespace ballpiston::client
