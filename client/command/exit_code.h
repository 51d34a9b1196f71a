// The program's exit codes; scripts rely on them.
#ifndef BALLPISTON_CLIENT_COMMAND_EXIT_CODE_H_
#define BALLPISTON_CLIENT_COMMAND_EXIT_CODE_H_

#include "absl/status/status.h"

namespace ballpiston::client {

enum class ExitCode {
  kDone = 0,
  kUsage = 2,        // usage, or an argument that is not valid
  kUnreachable = 3,  // no server answers
  kFailed = 4,       // the job failed or was cancelled, or its state forbids what was asked
  kNotFound = 5,     // no such job
  kNotPermitted = 6,
  kInterrupted = 130  // Ctrl-C
};

// Of a call that failed. What has no code of its own counts as kFailed.
ExitCode ExitCodeOf(const absl::Status& status);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_EXIT_CODE_H_
