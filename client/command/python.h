// The Python package `ballpiston` that belongs to this program. Some verbs start its programs.
//
// The interpreter is BALLPISTON_PYTHON, by default python3 in PATH.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace ballpiston::client {

// Its folder in the build or in the installation of this program. It may be missing.
std::filesystem::path PythonPackage();

// FAILED_PRECONDITION if the interpreter cannot import one of the modules. `purpose` begins the
// message; `packages` are Debian's names.
absl::Status CheckPython(const std::string& purpose, const std::vector<std::string>& modules,
                         const std::string& packages);

// The command that runs the interpreter with these arguments. Adds the package to PYTHONPATH of
// this process, which the interpreter inherits.
std::vector<std::string> PythonCommand(const std::vector<std::string>& arguments);

}  // namespace ballpiston::client
