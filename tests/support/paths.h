// Paths of the project's files and programs.
#pragma once

#include <string>

namespace ballpiston {

// The path of a file or folder of the project. `relative` is its path in the project, such as
// "tests/data/first_hit.csv".
std::string SourcePath(const std::string& relative);

// The same for a file or folder of this test's build folder.
std::string BuildPath(const std::string& relative);

std::string ServerProgram();  // ballpistond
std::string ClientProgram();  // ballpiston

}  // namespace ballpiston
