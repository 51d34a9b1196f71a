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

// Where a build and an installation have the package, relative to the folder of this program.
constexpr const char* kFolders[] = {"../python", "../lib/python3/dist-packages"};

std::string Interpreter() {
  const std::string chosen = FromEnvironment("BALLPISTON_PYTHON");
  return chosen.empty() ? "python3" : chosen;
}

// The package of this program comes first, so that both have the same version.
void AddPackage() {
  std::vector<std::string> path;
  std::error_code error;
  for (const char* folder : kFolders) {
    const fs::path place = fs::path(ProgramBeside(folder)).lexically_normal();
    if (fs::exists(place / "ballpiston", error)) path.push_back(place.string());
  }
  const std::string old = FromEnvironment("PYTHONPATH");
  if (!old.empty()) path.push_back(old);
  if (!path.empty()) setenv("PYTHONPATH", absl::StrJoin(path, ":").c_str(), 1);
}

}  // namespace

std::vector<std::string> PythonCommand(const std::vector<std::string>& arguments) {
  static const bool kAdded [[maybe_unused]] = (AddPackage(), true);
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
