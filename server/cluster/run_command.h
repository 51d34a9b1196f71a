// Runs another program to its end, with a time limit.
#pragma once

#include <chrono>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace ballpiston::server {

struct Command {
  std::vector<std::string> words;             // the program, looked up in PATH, and its arguments
  std::vector<std::string> environment = {};  // NAME=VALUE
  std::chrono::milliseconds limit;            // after this time the program is killed
};

struct CommandOutput {
  int exit_code = 0;   // 128 and the number of the signal that ended it
  std::string output;  // standard output; this and the errors at most 64 MiB
  std::string errors;  // standard error
};

// The program's standard input is empty. Kills the program at the limit (DEADLINE_EXCEEDED) and
// when stop is requested (CANCELLED). NOT_FOUND if there is no such program; UNAVAILABLE if the
// system cannot start it.
absl::StatusOr<CommandOutput> RunCommand(const Command& command, const std::stop_token& stop);

}  // namespace ballpiston::server
