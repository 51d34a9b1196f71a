#include "client/command/python.h"

#include <cstdlib>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/command/config_file.h"
#include "client/library/child_process.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

std::string Interpreter() {
  const std::string chosen = FromEnvironment("BALLPISTON_PYTHON");
  return chosen.empty() ? "python3" : chosen;
}

// This package comes before others, which may be of another version.
std::string PythonPath() {
  const std::string others = FromEnvironment("PYTHONPATH");
  return absl::StrCat(PythonPackage().parent_path().string(), others.empty() ? "" : ":", others);
}

}  // namespace

fs::path PythonPackage() {
  const fs::path prefix = fs::path(ProgramBeside("")).parent_path().parent_path();
  const fs::path built = prefix / "python", installed = prefix / BALLPISTON_PYTHON_DIR;
  return (fs::exists(built) ? built : installed) / "ballpiston";
}

std::vector<std::string> PythonCommand(const std::vector<std::string>& arguments) {
  static const int kOnce [[maybe_unused]] = setenv("PYTHONPATH", PythonPath().c_str(), 1);
  std::vector<std::string> command = {Interpreter()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

absl::Status CheckPython(const std::string& purpose, const std::vector<std::string>& modules,
                         const std::string& packages) {
  const auto status = RunChild(
      {.command = PythonCommand({"-c", absl::StrCat("import ", absl::StrJoin(modules, ", "))}),
       .output = "/dev/null"});
  if (status.ok() && *status == 0) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat(purpose, " needs the Python package: ", Interpreter(), " cannot import ",
                   absl::StrJoin(modules, ", "), "; install ", packages,
                   ", or name an interpreter that has them with BALLPISTON_PYTHON"));
}

}  // namespace ballpiston::client
