// ballpiston figure NAME --out DIR: starts the Python package ballpiston.figures, which asks the
// server, computes, writes the data as CSV files, and draws. Prints the paths of the files.
//
// The modules of the figures are NAME.py in ballpiston/figures, in the folder of Python packages
// that belongs to this program. The package knows which flags a figure has
// (client/python/ballpiston/figures/parts/command.py).

#include <algorithm>
#include <filesystem>
#include <set>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "client/command/python.h"
#include "client/command/suggestion.h"
#include "client/command/verb_table.h"
#include "client/library/installed_files.h"
#include "client/library/server_process.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

constexpr char kFigurePackages[] = "python3-ballpiston and python3-matplotlib";

fs::path FiguresFolder() { return PythonPackage() / "figures"; }

fs::path ModuleOf(const std::string& figure) {
  return FiguresFolder() / (absl::StrReplaceAll(figure, {{"-", "_"}}) + ".py");
}

absl::Status CheckInstalled() {
  if (!FigureNames().empty()) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("figures need the Python package in ",
                                                    FiguresFolder().string(),
                                                    ": install the packages ", kFigurePackages));
}

// A module begins with """TITLE.
VerbResult ListFigures(Terminal& terminal) {
  if (absl::Status missing = CheckInstalled(); !missing.ok()) return missing;
  for (const std::string& name : FigureNames()) {
    const std::string module = Contents(ModuleOf(name));
    const std::string title = module.substr(0, module.find('\n'));
    terminal.out << name << ": " << absl::StrReplaceAll(title, {{"\"\"\"", ""}}) << '\n';
  }
  return ExitCode::kDone;
}

absl::Status CheckName(const Options& options) {
  if (absl::Status missing = CheckInstalled(); !missing.ok()) return missing;
  const std::vector<std::string> names = FigureNames();
  if (options.figure.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("name a figure (", absl::StrJoin(names, ", "), ") or give --list"));
  }
  if (std::find(names.begin(), names.end(), options.figure) == names.end()) {
    return absl::InvalidArgumentError(absl::StrCat("figure ", NotOneOf(options.figure, names)));
  }
  if (options.given.contains("--quick") && options.given.contains("--full")) {
    return absl::InvalidArgumentError("--quick and --full exclude each other: give one of them");
  }
  if (!options.out.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError("--out is missing: name a folder for data and pictures");
}

std::vector<std::string> ArgumentsOf(const Options& options) {
  std::vector<std::string> arguments = {options.figure, "--out", options.out};
  if (options.effort != "default") arguments.push_back("--" + options.effort);
  if (options.edit) arguments.push_back("--edit");
  for (const auto& [name, value] : options.variables) {
    arguments.insert(arguments.end(), {"--" + absl::StrReplaceAll(name, {{"_", "-"}}), value});
  }
  return arguments;
}

}  // namespace

// The modules of the package's folder; names with _ are its own.
std::vector<std::string> FigureNames() {
  std::set<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(FiguresFolder(), error)) {
    const std::string stem = entry.path().stem();
    if (entry.path().extension() == ".py" && stem.front() != '_') {
      names.insert(absl::StrReplaceAll(stem, {{"_", "-"}}));
    }
  }
  return {names.begin(), names.end()};
}

VerbResult Figure(const Options& options, Terminal& terminal) {
  if (options.list) return ListFigures(terminal);
  if (absl::Status bad = CheckName(options); !bad.ok()) return bad;
  if (absl::Status bad =
          CheckPython("figure " + options.figure, {"ballpiston", "matplotlib"}, kFigurePackages);
      !bad.ok()) {
    return bad;
  }
  return RunPythonProgram("ballpiston.figures", ArgumentsOf(options), options, terminal);
}

}  // namespace ballpiston::client
