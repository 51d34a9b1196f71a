// Programs of the Python package `ballpiston`, which some verbs start.
//
// The interpreter is BALLPISTON_PYTHON, by default python3. It also finds the package of this
// program's own installation or build folder.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace ballpiston::client {

// FAILED_PRECONDITION if the interpreter cannot import one of the modules. `purpose` begins the
// message, for instance "--save FILE.npz"; `packages` are Debian's names.
absl::Status CheckPython(const std::string& purpose, const std::vector<std::string>& modules,
                         const std::string& packages);

// The child process of the interpreter with these arguments.
std::vector<std::string> PythonCommand(const std::vector<std::string>& arguments);

}  // namespace ballpiston::client
