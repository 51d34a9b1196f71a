// ballpiston figure NAME --out DIR: starts the Python package ballpiston.figures, which asks the
// server, computes, writes the data as CSV files, and draws. Prints the paths of the files.
//
// The modules of the figures are NAME.py in ballpiston/figures, in the folder of Python packages
// that belongs to this program. The package knows which flags a figure has
// (client/python/ballpiston/figures/parts/command.py).
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "client/command/config_file.h"
#include "client/command/follow_job.h"
#include "client/command/interrupts.h"
#include "client/command/python.h"
#include "client/command/suggestion.h"
#include "client/command/verb_table.h"
#include "client/library/child_process.h"
#include "client/library/installed_files.h"
#include "client/library/server_process.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

fs::path FiguresFolder() { return PythonPackage() / "figures"; }

fs::path ModuleOf(const std::string& figure) {
  return FiguresFolder() / (absl::StrReplaceAll(figure, {{"-", "_"}}) + ".py");
}

absl::Status CheckInstalled() {
  if (!FigureNames().empty()) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("figures need the Python package in ", FiguresFolder().string(),
                   ": install the packages python3-ballpiston and python3-matplotlib"));
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

std::vector<std::string> Command(const Options& options) {
  std::vector<std::string> command =
      PythonCommand({"-m", "ballpiston.figures", options.figure, "--out", options.out});
  if (options.effort != "default") command.push_back("--" + options.effort);
  if (options.edit) command.push_back("--edit");
  for (const auto& [name, value] : options.variables) {
    command.insert(command.end(), {"--" + absl::StrReplaceAll(name, {{"_", "-"}}), value});
  }
  return command;
}

// The flags of `figure` that choose the server and the progress, for the package, which starts this
// program if it needs a private server. The user's config file has no effect on it.
void SetEnvironment(const Options& options) {
  const auto set = [](const std::string& name, const std::string& value) {
    setenv(name.c_str(), value.c_str(), 1);
  };
  set("BALLPISTON_PROGRAM", ProgramBeside("ballpiston"));
  set("BALLPISTON_SERVER_PROGRAM", UsualServerProgram());
  for (const auto& [name, value] : options.inherited) set(name, value);
  set("BALLPISTON_CONFIG", "/dev/null");
  if (StyleOf(options) == ProgressStyle::kNone) set("BALLPISTON_PROGRESS", "none");
}

// An interruption ends the package and every program that it has started; its jobs continue.
absl::StatusOr<int> RunPackage(const Options& options, const Terminal& terminal) {
  const absl::StatusOr<pid_t> pid =
      StartChild({.command = Command(options), .folder = "", .output = "", .own_group = true});
  if (!pid.ok()) {
    return absl::FailedPreconditionError(
        absl::StrCat("figures need Python, but ", pid.status().message(),
                     ": install the packages python3-ballpiston and python3-matplotlib"));
  }
  const Interrupts::Scope scope(terminal.interrupts, [&] {
    kill(-*pid, SIGINT);
    WaitForChild(*pid).IgnoreError();
    terminal.err << (isatty(STDERR_FILENO) ? "\r\x1b[K" : "")
                 << "The figure is not finished: run the same command again.\n";
  });
  return WaitForChild(*pid);
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
  SetEnvironment(options);
  terminal.out.flush();
  const absl::StatusOr<int> status = RunPackage(options, terminal);
  if (!status.ok()) return status.status();
  return ExitCodeOf(*status);
}

}  // namespace ballpiston::client
