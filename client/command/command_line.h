// The whole program: parses the command line, runs the verb, prints errors, returns the exit code.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/command/exit_code.h"
#include "client/command/options.h"
#include "client/command/terminal.h"
#include "client/command/verb_table.h"

namespace ballpiston::client {

struct CommandLine {
  const Verb* verb = nullptr;  // null: the program's own page
  Options options = {};
  std::string page = {};  // text of --help or --version; if set, only this is printed
};

// Parses the words after the program's name. A flag that is not given takes its value from the
// environment, else from the config file. INVALID_ARGUMENT describes the first error: the flag, its
// text and the permitted values.
absl::StatusOr<CommandLine> ParseCommandLine(const std::vector<std::string>& words);

// Turns off the log of Protocol Buffers for the rest of the process.
ExitCode RunCommandLine(const std::vector<std::string>& words, Terminal& terminal);

}  // namespace ballpiston::client
