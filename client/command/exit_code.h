// The program's exit codes; scripts rely on them.
#ifndef BALLPISTON_CLIENT_COMMAND_EXIT_CODE_H_
#define BALLPISTON_CLIENT_COMMAND_EXIT_CODE_H_

#include "absl/status/status.h"

namespace ballpiston::client {

enum class ExitCode {
  kDone = 0,
  kUsage = 2,        // usage, or an argument that is not valid, or a job too large for the server
  kUnreachable = 3,  // no server answers, or the server is busy: retry later
  kFailed = 4,       // the job failed or was cancelled, or its state forbids what was asked
  kNotFound = 5,     // no such job, or no result of that point
  kNotPermitted = 6,
  kInterrupted = 130  // Ctrl-C
};

// Of a call that failed. What has no code of its own counts as kFailed. Of the server's limits
// those on a single job are kUsage, and those on what it has to do at once kUnreachable.
ExitCode ExitCodeOf(const absl::Status& status);

// Converts the exit status of a child program: the same code if it is one of these, else kFailed.
ExitCode ExitCodeOf(int exit_status);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_EXIT_CODE_H_
