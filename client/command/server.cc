// ballpiston server: starts, stops, checks and backs up servers on this machine, and makes tokens.
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/command/connection.h"
#include "client/command/interrupts.h"
#include "client/library/local_server.h"
#include "client/library/server_process.h"

namespace ballpiston::client {
namespace {

// A server on this machine: its data folder and the command that starts it.
absl::StatusOr<ServerProgram> ProgramOf(const Options& options) {
  if (options.data_dir.empty()) {
    const absl::StatusOr<LocalServer> local = FindLocalServer();
    if (!local.ok()) return local.status();
    if (!options.server.empty() && options.server != local->Address()) {
      return absl::InvalidArgumentError(absl::StrCat(
          "your commands use the server ", options.server,
          " (BALLPISTON_SERVER, or server in the config file), not the private server: give the "
          "server's --data-dir; the private server's is ",
          local->folder));
    }
    return ServerProgram{local->program, local->folder, {"--listen", local->Address()}};
  }
  std::error_code error;
  const std::string folder = std::filesystem::absolute(options.data_dir, error).string();
  return ServerProgram{UsualServerProgram(), folder, {}};
}

absl::Status CheckStart(const Options& options) {
  const bool has_address = std::any_of(
      options.server_flags.begin(), options.server_flags.end(), [](const std::string& flag) {
        return flag == "--listen" || absl::StartsWith(flag, "--listen=");
      });
  if (!has_address || !options.data_dir.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "--listen: the private server has a fixed address; to start a server with another address, "
      "give it its own folder with --data-dir");
}

// FAILED_PRECONDITION if flags were given: they have no effect on a running server.
VerbResult ReportRunning(const std::string& folder, const RunningServer& running,
                         const Options& options, const Terminal& terminal) {
  if (!options.server_flags.empty()) {
    return absl::FailedPreconditionError(
        absl::StrCat("a server already runs in ", folder, ", at ", running.address,
                     ": these flags have no effect; stop that server first (ballpiston server stop",
                     options.data_dir.empty() ? "" : absl::StrCat(" --data-dir ", folder), ")"));
  }
  terminal.Note(
      "a server already runs there; if a client started that server, it stops when it is idle");
  terminal.out << running.address << '\n';
  return ExitCode::kDone;
}

// Makes the data folder for the log, before the server starts. A new folder is for this user only.
absl::Status MakeFolder(const std::string& folder) {
  std::error_code error;
  const bool is_new = std::filesystem::create_directories(folder, error);
  if (is_new) std::filesystem::permissions(folder, std::filesystem::perms::owner_all, error);
  if (!error) return absl::OkStatus();
  return absl::PermissionDeniedError(
      absl::StrCat("--data-dir: cannot make the folder ", folder, ": ", error.message()));
}

// Runs a command of ballpistond that starts no server, and waits for its end. Its output is this
// program's output.
VerbResult RunBallpistond(std::vector<std::string> flags, const Terminal& terminal) {
  flags.insert(flags.begin(), UsualServerProgram());
  terminal.Detail(absl::StrJoin(flags, " "));
  const absl::StatusOr<int> status =
      RunInterruptible({.command = std::move(flags)}, [](pid_t pid) { kill(pid, SIGTERM); });
  if (!status.ok()) return absl::FailedPreconditionError(status.status().message());
  return ExitCodeOf(*status);
}

VerbResult RunOnStore(const Options& options, std::vector<std::string> flags,
                      const Terminal& terminal) {
  const absl::StatusOr<ServerProgram> program = ProgramOf(options);
  if (!program.ok()) return program.status();
  flags.insert(flags.end(), {"--data-dir", program->folder});
  return RunBallpistond(std::move(flags), terminal);
}

}  // namespace

VerbResult ServerStart(const Options& options, Terminal& terminal) {
  if (absl::Status bad = CheckStart(options); !bad.ok()) return bad;
  absl::StatusOr<ServerProgram> program = ProgramOf(options);
  if (!program.ok()) return program.status();
  const auto running = FindServer(program->folder);
  if (running && !running->address.empty()) {
    return ReportRunning(program->folder, *running, options, terminal);
  }
  if (absl::Status made = MakeFolder(program->folder); !made.ok()) return made;
  program->run_in = "";  // so that relative paths in its flags are correct
  program->flags.insert(program->flags.end(), options.server_flags.begin(),
                        options.server_flags.end());
  const absl::StatusOr<std::string> address = StartServer(*program);
  if (!address.ok()) return address.status();
  terminal.Detail(absl::StrCat("log ", program->Log()));
  terminal.out << *address << '\n';
  return ExitCode::kDone;
}

VerbResult ServerStop(const Options& options, Terminal&) {
  const absl::StatusOr<ServerProgram> program = ProgramOf(options);
  if (!program.ok()) return program.status();
  if (absl::Status stopped = StopServer(program->folder); !stopped.ok()) return stopped;
  return ExitCode::kDone;
}

VerbResult ServerToken(const Options& options, Terminal& terminal) {
  return RunBallpistond({"--access-file", options.access_file, "--new-token", options.credential},
                        terminal);
}

VerbResult ServerBackup(const Options& options, Terminal& terminal) {
  return RunOnStore(options, {"--backup", options.file}, terminal);
}

VerbResult ServerCheck(const Options& options, Terminal& terminal) {
  return RunOnStore(options, {"--check"}, terminal);
}

}  // namespace ballpiston::client
