// The Python package `ballpiston` that belongs to this program. Some verbs start its programs.
//
// The interpreter is BALLPISTON_PYTHON, by default python3 in PATH, or /usr/bin/python3 if that one
// lacks the needed packages.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/command/verbs.h"

namespace ballpiston::client {

// INVALID_ARGUMENT if the interpreter cannot import one of the modules: the message names those
// that are missing. `purpose` begins the message; `packages` are Debian's names.
absl::Status CheckPython(const std::string& purpose, const std::vector<std::string>& modules,
                         const std::string& packages);

// The same for a file of arrays or a table, such as "--out FILE.npz": .parquet needs more modules.
absl::Status CheckPythonFor(const std::string& flag_and_path);

// Whether --out names a file .csv, .npz or .parquet that can be created.
absl::Status CheckTableFile(const std::string& out);

// Runs a program of the package: python3 -m MODULE ARGUMENT... The flags of the options that choose
// the server and the progress are in its environment, and the user's config file has no effect on
// it. An interruption ends the program and all that it has started; its jobs continue. Call
// CheckPython first for the modules that the program needs.
VerbResult RunPythonProgram(const std::string& module, const std::vector<std::string>& arguments,
                            const Options& options, Terminal& terminal);

}  // namespace ballpiston::client
