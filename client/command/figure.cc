// ballpiston figure NAME --out DIR: runs the figure's script in the folder DIR. The script runs
// ballpiston commands to get the data, writes CSV files and draws with gnuplot. Prints the paths of
// the files.
//
// A figure consists of the scripts NAME.sh and NAME.gnuplot in share/ballpiston/figures beside this
// program's folder. All figures share figure.sh and style.gnuplot. These four files are copied to
// the --out folder. A file that exists there is kept: the user may have edited it. A script takes
// its variables from the environment: ${rho:=...}.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "client/command/config_file.h"
#include "client/command/follow_job.h"
#include "client/command/interrupts.h"
#include "client/command/suggestion.h"
#include "client/command/verb_table.h"
#include "client/library/child_process.h"
#include "client/library/installed_files.h"
#include "client/library/server_process.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

constexpr char kScript[] = ".sh";
constexpr char kPicture[] = ".gnuplot";
constexpr const char* kShared[] = {"figure.sh", "style.gnuplot"};

fs::path ProgramFolder() { return fs::path(ProgramBeside("")).parent_path(); }

fs::path FiguresFolder() { return InstalledFolder("figures"); }

absl::Status CheckInstalled() {
  if (!FigureNames().empty()) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("no figures are installed in ", FiguresFolder().string()));
}

// The first line is "# TITLE".
VerbResult ListFigures(Terminal& terminal) {
  if (absl::Status missing = CheckInstalled(); !missing.ok()) return missing;
  for (const std::string& name : FigureNames()) {
    const std::string script = Contents(FiguresFolder() / (name + kScript));
    terminal.out << name << ": " << script.substr(2, script.find('\n') - 1);
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
  return absl::InvalidArgumentError("--out is missing: name a folder for data, script and picture");
}

absl::Status Provide(const fs::path& folder, const std::string& name, const Terminal& terminal) {
  const fs::path installed = FiguresFolder() / name, here = folder / name;
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error && !fs::exists(here, error)) fs::copy_file(installed, here, error);
  if (error) {
    return absl::InvalidArgumentError(
        absl::StrCat("--out: cannot write ", here.string(), ": ", error.message()));
  }
  if (Contents(here) != Contents(installed)) {
    terminal.Note(absl::StrCat(
        "ballpiston: using ", here.string(),
        ", which differs from the installed file; delete it to use the installed file"));
  }
  return absl::OkStatus();
}

absl::Status ProvideScripts(const fs::path& folder, const std::string& figure,
                            const Terminal& terminal) {
  std::vector<std::string> names = {std::begin(kShared), std::end(kShared)};
  names.insert(names.begin(), {figure + kScript, figure + kPicture});
  for (const std::string& name : names) {
    if (absl::Status status = Provide(folder, name, terminal); !status.ok()) return status;
  }
  return absl::OkStatus();
}

// The script in the folder, else the installed script.
std::string ScriptFor(const fs::path& folder, const std::string& name) {
  std::error_code error;
  return Contents((fs::exists(folder / name, error) ? folder : FiguresFolder()) / name);
}

// The names in ${NAME:=...}.
std::set<std::string> VariablesOf(const std::string& script) {
  std::set<std::string> names;
  for (size_t at = script.find("${"); at != std::string::npos; at = script.find("${", at + 2)) {
    const size_t end = script.find(":=", at);
    if (end != std::string::npos) names.insert(script.substr(at + 2, end - at - 2));
  }
  return names;
}

absl::Status CheckVariables(const Options& options, const std::set<std::string>& names) {
  for (const auto& [name, value] : options.variables) {
    const std::string flag = "--" + absl::StrReplaceAll(name, {{"_", "-"}});
    if (names.contains(name) || !options.given.contains(flag)) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(flag, ": the figure ", options.figure, " has no such variable"));
  }
  return absl::OkStatus();
}

// Sets the environment of the script: in PATH this program's folder and, as installed, the folder
// of the programs that only figures use (tools/README.md); the flags of `figure`, and the script's
// variables. The user's config file and variables of the same names have no effect.
void SetEnvironment(const Options& options, const std::set<std::string>& names) {
  const auto set = [](const std::string& name, const std::string& value) {
    setenv(name.c_str(), value.c_str(), 1);
  };
  const std::string path = FromEnvironment("PATH");
  const fs::path libexec = ProgramFolder().parent_path() / "libexec" / "ballpiston";
  set("PATH",
      absl::StrCat(ProgramFolder().string(), ":", libexec.string(), path.empty() ? "" : ":", path));
  set("BALLPISTON_SERVER_PROGRAM", UsualServerProgram());
  for (const auto& [name, value] : options.inherited) set(name, value);
  set("BALLPISTON_CONFIG", "/dev/null");
  if (StyleOf(options) == ProgressStyle::kNone) set("BALLPISTON_PROGRESS", "none");
  for (const std::string& name : names) unsetenv(name.c_str());
  set("effort", options.effort);
  for (const auto& [name, value] : options.variables) set(name, value);
}

// An interruption ends the script and every program that it has started; its jobs continue. The
// trap makes the shell wait until the running command has printed how to watch its job.
absl::StatusOr<int> RunScript(const Options& options, const Terminal& terminal) {
  const std::string commands =
      absl::StrCat("trap 'exit 130' INT TERM HUP; . ./", options.figure, kScript);
  const absl::StatusOr<pid_t> pid = StartChild(
      {.command = {"sh", "-c", commands}, .folder = options.out, .output = "", .own_group = true});
  if (!pid.ok()) return absl::FailedPreconditionError(pid.status().message());
  const Interrupts::Scope scope(terminal.interrupts, [&] {
    kill(-*pid, SIGINT);
    WaitForChild(*pid).IgnoreError();
    terminal.err << (isatty(STDERR_FILENO) ? "\r\x1b[K" : "")
                 << "The figure is not finished: run the same command again.\n";
  });
  return WaitForChild(*pid);
}

// NAME.csv and NAME-data.csv are files of the figure NAME, unless another figure has a longer name
// with which the file's name begins.
bool IsFileOf(const std::string& file, const std::string& figure) {
  const auto begins_with = [&file](const std::string& name) {
    return absl::StartsWith(file, name + ".") || absl::StartsWith(file, name + "-");
  };
  const std::vector<std::string> names = FigureNames();
  return begins_with(figure) && std::none_of(names.begin(), names.end(), [&](const auto& other) {
           return other.size() > figure.size() && begins_with(other);
         });
}

// The paths of the figure's files, in order.
void PrintFiles(const fs::path& folder, const std::string& figure, const Terminal& terminal) {
  std::set<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (IsFileOf(entry.path().filename(), figure)) files.insert(entry);
  }
  for (const fs::path& file : files) terminal.out << file.string() << '\n';
}

}  // namespace

std::vector<std::string> FigureNames() {
  std::set<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(FiguresFolder(), error)) {
    if (entry.path().extension() == kPicture &&
        fs::exists(fs::path(entry).replace_extension(kScript))) {
      names.insert(entry.path().stem());
    }
  }
  return {names.begin(), names.end()};
}

VerbResult Figure(const Options& options, Terminal& terminal) {
  if (options.list) return ListFigures(terminal);
  if (absl::Status bad = CheckName(options); !bad.ok()) return bad;
  const fs::path folder = options.out;
  const std::set<std::string> names = VariablesOf(ScriptFor(folder, options.figure + kScript));
  if (absl::Status bad = CheckVariables(options, names); !bad.ok()) return bad;
  if (absl::Status status = ProvideScripts(folder, options.figure, terminal); !status.ok()) {
    return status;
  }
  if (!options.edit) {
    SetEnvironment(options, names);
    const absl::StatusOr<int> status = RunScript(options, terminal);
    if (!status.ok()) return status.status();
    if (*status != 0) return ExitCodeOf(*status);
  }
  PrintFiles(folder, options.figure, terminal);
  return ExitCode::kDone;
}

}  // namespace ballpiston::client
