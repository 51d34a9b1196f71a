// Where the project's files and programs are.
#ifndef BALLPISTON_TESTS_SUPPORT_PATHS_H_
#define BALLPISTON_TESTS_SUPPORT_PATHS_H_

#include <string>

namespace ballpiston {

// A file or folder of the project, by its path from the project's folder: "tests/data/kernel.csv".
std::string SourcePath(const std::string& relative);

// The same of the build that this test belongs to.
std::string BuildPath(const std::string& relative);

std::string ServerProgram();  // ballpistond
std::string ClientProgram();  // ballpiston

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_SUPPORT_PATHS_H_
