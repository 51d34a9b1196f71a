// The program's exit codes; scripts rely on them.
#pragma once

#include "absl/status/status.h"

namespace ballpiston::client {

enum class ExitCode {
  kDone = 0,
  // Wrong usage or an invalid argument, a job too large for the server, or output that cannot be
  // written.
  kUsage = 2,
  kUnreachable = 3,  // no server answers, or the server is busy: retry later
  kFailed = 4,       // the job failed or was cancelled, or its state does not permit the call
  kNotFound = 5,     // no such job, or no result of that point
  kNotPermitted = 6,
  kInterrupted = 130  // Ctrl-C
};

// The exit code for a failed call. An error without its own exit code is kFailed. A server's limit
// is kUnreachable if the server says when to retry (RetryInfo), else kUsage.
ExitCode ExitCodeOf(const absl::Status& status);

// Converts the exit status of a child program: the same number if it is an ExitCode, else kFailed.
ExitCode ExitCodeOf(int exit_status);

}  // namespace ballpiston::client
