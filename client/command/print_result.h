// Fetches a job's finished points and prints them: the end of `run`. print_result.cc also has the
// verb `result`.
#pragma once

#include <string>

#include "client/command/connection.h"
#include "client/command/terminal.h"

namespace ballpiston::client {

// Checks --save before a job runs: the file's ending and folder. INVALID_ARGUMENT names the flag.
absl::Status CheckSave(const Options& options);

// kFailed for a job that failed or was cancelled; its finished points are printed too.
// FAILED_PRECONDITION, with a hint, if the results have expired; then nothing is printed.
// `answered_from_store` is the value that Create returned: the server does not store it.
// With --save the result goes to that file, whose path is printed.
VerbResult PrintResult(const Connection& connection, const std::string& name,
                       const Options& options, Terminal& terminal,
                       bool answered_from_store = false);

}  // namespace ballpiston::client
