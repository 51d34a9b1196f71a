// ballpiston figure and export: each starts a program of the Python package and returns its exit
// code.
#include "client/command/python.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "client/command/connection.h"
#include "client/command/follow_job.h"
#include "client/command/interrupts.h"
#include "client/command/settings.h"
#include "client/command/suggestion.h"
#include "client/command/verb_table.h"
#include "client/library/child_process.h"
#include "client/library/quoted.h"
#include "client/library/server_process.h"
#include "client/output/output_file.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

std::string Interpreter() {
  const std::string chosen = FromEnvironment("BALLPISTON_PYTHON");
  return chosen.empty() ? "python3" : chosen;
}

// Its folder in the build or in the installation of this program. It may be missing.
fs::path PythonPackage() {
  const fs::path prefix = fs::path(ProgramBeside("")).parent_path().parent_path();
  const fs::path built = prefix / "python", installed = prefix / BALLPISTON_PYTHON_DIR;
  return (fs::exists(built) ? built : installed) / "ballpiston";
}

// This package comes before others, which may be of another version.
std::string PythonPath() {
  const std::string others = FromEnvironment("PYTHONPATH");
  return absl::StrCat(PythonPackage().parent_path().string(), others.empty() ? "" : ":", others);
}

// The package starts this program if it needs a private server.
void SetEnvironment(const Options& options) {
  const auto set = [](const std::string& name, const std::string& value) {
    setenv(name.c_str(), value.c_str(), 1);
  };
  set("BALLPISTON_PROGRAM", ProgramBeside("ballpiston"));
  set("BALLPISTON_SERVER_PROGRAM", UsualServerProgram());
  set("BALLPISTON_SERVER", options.server);
  set("BALLPISTON_CA", options.security.ca);
  set("BALLPISTON_TLS", options.security.tls ? "true" : "");
  set("BALLPISTON_TOKEN_FILE", options.security.token_file);
  set("BALLPISTON_TOKEN", options.security.token);
  set("BALLPISTON_CONFIG", "/dev/null");
  set("BALLPISTON_PROGRESS", WordOf(StyleOf(options), kProgressStyles));
}

// The command that runs the interpreter with these arguments. The interpreter inherits two
// variables: it looks for modules in this package first, and never in the working folder, which may
// have a random.py.
std::vector<std::string> PythonCommand(const std::vector<std::string>& arguments) {
  static const bool kIsSet [[maybe_unused]] = [] {
    setenv("PYTHONPATH", PythonPath().c_str(), 1);
    setenv("PYTHONSAFEPATH", "1", 1);
    return true;
  }();
  std::vector<std::string> command = {Interpreter()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

}  // namespace

VerbResult RunPythonProgram(const std::string& module, const std::vector<std::string>& arguments,
                            const Options& options, Terminal& terminal) {
  SetEnvironment(options);
  terminal.Detail("program " + Interpreter());
  terminal.out.flush();
  std::vector<std::string> words = {"-m", module};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const auto stop = [&terminal](pid_t pid) {
    kill(-pid, SIGTERM);  // while Python starts, SIGINT would print a traceback
    terminal.err << (isatty(STDERR_FILENO) ? "\r\x1b[K" : "")
                 << "The file is not finished: run the same command again.\n";
    WaitForChild(pid).IgnoreError();
  };
  const absl::StatusOr<int> status =
      RunInterruptible({.command = PythonCommand(words), .own_group = true}, stop);
  if (!status.ok()) return status.status();
  if (*status > 128 && *status != static_cast<int>(ExitCode::kInterrupted)) {
    return absl::InternalError(
        absl::StrCat(Interpreter(), " was ended by signal ", *status - 128,
                     *status == 128 + SIGKILL ? ", perhaps because it needs too much memory" : ""));
  }
  return ExitCodeOf(*status);
}

absl::Status CheckPython(const std::string& purpose, const std::vector<std::string>& modules,
                         const std::string& packages) {
  const auto can_import = [](const std::string& names) {
    const auto status =
        RunChild({.command = PythonCommand({"-c", "import " + names}), .output = "/dev/null"});
    return status.ok() && *status == 0;
  };
  const std::string all = absl::StrJoin(modules, ", ");
  if (can_import(all)) return absl::OkStatus();
  if (FromEnvironment("BALLPISTON_PYTHON").empty()) {
    setenv("BALLPISTON_PYTHON", "/usr/bin/python3", 1);
    if (can_import(all)) return absl::OkStatus();
    unsetenv("BALLPISTON_PYTHON");  // the message names python3
  }
  std::vector<std::string> missing = modules;
  std::erase_if(missing, can_import);
  if (missing.empty()) missing = modules;  // each can be imported alone, but not all together
  return absl::InvalidArgumentError(
      absl::StrCat(purpose, " needs the Python package: ", Interpreter(), " cannot import ",
                   absl::StrJoin(missing, ", "), "; install ", packages,
                   ", or name an interpreter that has them with BALLPISTON_PYTHON"));
}

absl::Status CheckTableFile(const std::string& out) {
  const auto ends_in = [&out](const char* ending) { return absl::EndsWith(out, ending); };
  if (!ends_in(".csv") && !ends_in(".npz") && !ends_in(".parquet")) {
    return absl::InvalidArgumentError(
        absl::StrCat("--out: ", Quoted(out), " does not end in .csv, .npz or .parquet"));
  }
  return CheckNewFile("--out", out);
}

absl::Status CheckPythonFor(const std::string& flag_and_path) {
  if (!absl::EndsWith(flag_and_path, ".parquet")) {
    return CheckPython(flag_and_path, {"ballpiston", "numpy"},
                       "python3-ballpiston and python3-numpy");
  }
  return CheckPython(
      flag_and_path, {"ballpiston", "pandas", "pyarrow"},
      "python3-ballpiston and python3-pandas, and pyarrow from the Python Package Index");
}

// The modules NAME.py in the folder of figures; names with _ are its own.
std::vector<std::string> FigureNames() {
  std::set<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(PythonPackage() / "figures", error)) {
    const std::string stem = entry.path().stem();
    if (entry.path().extension() == ".py" && stem.front() != '_') {
      names.insert(absl::StrReplaceAll(stem, {{"_", "-"}}));
    }
  }
  return {names.begin(), names.end()};
}

namespace {

// NAME: the first line of its module, without the quotes.
void ListFigures(std::ostream& out) {
  for (const std::string& name : FigureNames()) {
    const std::string file = absl::StrReplaceAll(name, {{"-", "_"}}) + ".py";
    std::ifstream in(PythonPackage() / "figures" / file);
    std::string title;
    std::getline(in, title);
    std::erase(title, '"');
    out << name << ": " << title << '\n';
  }
}

// The words with the figure's name first.
absl::StatusOr<std::vector<std::string>> FigureWords(std::vector<std::string> words) {
  const std::vector<std::string> names = FigureNames();
  if (names.empty()) return words;  // CheckPython names the missing package
  const auto name = std::find_first_of(words.begin(), words.end(), names.begin(), names.end());
  if (name != words.end()) {
    std::rotate(words.begin(), name, name + 1);
    return words;
  }
  if (words.empty() || absl::StartsWith(words[0], "-")) {
    return absl::InvalidArgumentError(
        absl::StrCat("name a figure (", absl::StrJoin(names, ", "), "), or give --list"));
  }
  return absl::InvalidArgumentError(absl::StrCat("NAME: ", NotOneOf(words[0], names)));
}

}  // namespace

VerbResult Figure(const Options& options, Terminal& terminal) {
  if (options.list && !FigureNames().empty()) {
    ListFigures(terminal.out);
    return ExitCode::kDone;
  }
  const auto words = FigureWords(options.words);
  if (!words.ok()) return words.status();
  if (absl::Status bad = CheckServerFlags(options); !bad.ok()) return bad;
  absl::Status bad = CheckPython("figure", {"ballpiston", "matplotlib"},
                                 "python3-ballpiston and python3-matplotlib");
  if (!bad.ok()) return bad;
  return RunPythonProgram("ballpiston.figures", *words, options, terminal);
}

VerbResult Export(const Options& options, Terminal& terminal) {
  if (!options.jobs.empty() && options.given.contains("--label")) {
    return absl::InvalidArgumentError(
        "--label and names of jobs exclude each other: give one of them, or neither");
  }
  if (absl::Status bad = CheckTableFile(options.out); !bad.ok()) return bad;
  if (absl::Status bad = CheckServerFlags(options); !bad.ok()) return bad;
  if (absl::Status bad = CheckPythonFor("--out " + options.out); !bad.ok()) return bad;
  std::vector<std::string> arguments = {"export", options.out};
  for (const auto& [key, value] : options.labels) {
    arguments.push_back(absl::StrCat(key, "=", value));
  }
  arguments.insert(arguments.end(), options.jobs.begin(), options.jobs.end());
  return RunPythonProgram("ballpiston.command", arguments, options, terminal);
}

}  // namespace ballpiston::client
