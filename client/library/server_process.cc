#include "client/library/server_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <thread>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/library/child_process.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

constexpr char kProgramName[] = "ballpistond";
constexpr uintmax_t kMaxLogBytes = 1 << 20;
constexpr absl::Duration kLookInterval = absl::Milliseconds(20);

// A server holds a lock on the file `lock` in its folder as long as it runs, and writes its process
// id there. It writes the address on which it listens to the file `server.address`.
constexpr char kLockFile[] = "/lock";
constexpr char kAddressFile[] = "/server.address";

std::string FirstLine(const std::string& path) {
  std::string line;
  std::getline(std::ifstream(path), line);
  return line;
}

bool IsLocked(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool locked = flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(file);
  return locked;
}

// Whether the process has the file open. The number alone does not prove this: the server may be on
// another machine with the same folder, or a later process may have the number.
bool HasOpen(pid_t pid, const std::string& path) {
  std::error_code error;
  for (const auto& file : fs::directory_iterator(absl::StrCat("/proc/", pid, "/fd"), error)) {
    if (fs::equivalent(file.path(), path, error)) return true;
  }
  return false;
}

// Waits until the condition is true or the time is over; returns whether it is true. It pauses
// between two checks, because a check holds the folder's lock for a moment if the lock is free.
template <typename Condition>
bool Await(absl::Duration timeout, Condition condition) {
  const absl::Time deadline = absl::Now() + timeout;
  while (!condition()) {
    if (absl::Now() > deadline) return false;
    absl::SleepFor(kLookInterval);
  }
  return true;
}

// Renames a long log. Returns the place in the log where the next server begins to write.
uintmax_t EndOfLog(const ServerProgram& program) {
  std::error_code error;
  if (fs::file_size(program.Log(), error) > kMaxLogBytes && !error) {
    fs::rename(program.Log(), program.Log() + ".old", error);
  }
  const uintmax_t size = fs::file_size(program.Log(), error);
  return error ? 0 : size;
}

absl::StatusOr<pid_t> StartProgram(const ServerProgram& program) {
  std::vector<std::string> command = {program.program, "--data-dir", program.folder};
  command.insert(command.end(), program.flags.begin(), program.flags.end());
  return StartChild({.command = std::move(command),
                     .folder = program.run_in,
                     .output = program.Log(),
                     .detached = true,
                     .without = "BALLPISTON_TOKEN"});  // the user's secret
}

// The last line from this place on; empty if there is none, or if the log is a device.
std::string LastLine(const std::string& log, uintmax_t start) {
  std::error_code error;
  if (!fs::is_regular_file(log, error)) return "";
  std::ifstream in(log);
  in.seekg(static_cast<std::streamoff>(start));
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

// Why a log is empty: perhaps it cannot be written.
std::string WhyEmpty(const std::string& log) {
  const int file = open(log.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  const bool is_written = file >= 0 && write(file, "\n", 1) == 1;
  const std::string reason = std::generic_category().message(errno);
  if (file >= 0) close(file);
  return is_written ? "(it wrote nothing)" : "its log cannot be written: " + reason;
}

// `exit_status`: of the program, if it has ended.
absl::Status Failure(const ServerProgram& program, uintmax_t log_start,
                     std::optional<int> exit_status) {
  std::string last = LastLine(program.Log(), log_start);
  if (last.empty()) last = WhyEmpty(program.Log());
  constexpr int kWrongFlags = 2, kNotPermitted = 6;
  const auto code = exit_status == kWrongFlags     ? absl::StatusCode::kInvalidArgument
                    : exit_status == kNotPermitted ? absl::StatusCode::kPermissionDenied
                                                   : absl::StatusCode::kUnavailable;
  const std::string what = !exit_status ? "does not answer"
                           : exit_status == kUnknownStatus
                               ? "ended at once"
                               : absl::StrCat("ended at once with exit status ", *exit_status);
  return absl::Status(code, absl::StrCat("the server ", program.program, " ", what, ": ", last,
                                         "\n  log: ", program.Log()));
}

}  // namespace

std::string UsualServerProgram() {
  const char* chosen = std::getenv("BALLPISTON_SERVER_PROGRAM");
  std::error_code error;
  if (chosen != nullptr && chosen[0] != '\0') {
    // The server runs in another folder; therefore a relative path is made absolute here.
    const bool is_path = absl::string_view(chosen).find('/') != absl::string_view::npos;
    return is_path ? fs::absolute(chosen, error).string() : chosen;
  }
  const std::string beside = ProgramBeside(kProgramName);
  return access(beside.c_str(), X_OK) == 0 ? beside : kProgramName;
}

std::optional<RunningServer> FindServer(const std::string& folder) {
  if (!IsLocked(folder + kLockFile)) return std::nullopt;
  RunningServer server;
  const bool is_known = absl::SimpleAtoi(FirstLine(folder + kLockFile), &server.pid) &&
                        HasOpen(server.pid, folder + kLockFile);
  if (!is_known) server.pid = 0;
  server.address = FirstLine(folder + kAddressFile);
  return server;
}

absl::StatusOr<std::string> StartServer(const ServerProgram& program, absl::Duration timeout) {
  const uintmax_t log_start = EndOfLog(program);
  const absl::StatusOr<pid_t> pid = StartProgram(program);
  if (!pid.ok()) {
    return absl::UnavailableError(
        absl::StrCat(pid.status().message(),
                     "; install the package ballpistond, or name a server with --server"));
  }
  std::string address;
  std::optional<int> exit_status;
  Await(timeout, [&] {
    const auto server = FindServer(program.folder);
    if (!exit_status) exit_status = ExitStatus(*pid);
    // The address may be that of another server, started at the same time. Until the new server's
    // id is known, it may also be that of an earlier server.
    if (server && (server->pid != 0 || exit_status)) address = server->address;
    return !address.empty() || (exit_status && !server);
  });
  // A long-lived program keeps no zombie of a server that ends, unless it can start no thread.
  try {
    if (!exit_status) std::thread([pid] { WaitForChild(*pid).IgnoreError(); }).detach();
  } catch (const std::system_error&) {
  }
  if (!address.empty()) return address;
  return Failure(program, log_start, exit_status);
}

absl::Status StopServer(const std::string& folder, absl::Duration timeout) {
  const auto server = FindServer(folder);
  if (!server) return absl::UnavailableError(absl::StrCat("no server runs in ", folder));
  if (server->pid == 0) {
    return absl::UnavailableError(absl::StrCat("the server that uses ", folder,
                                               " is just starting, or is on another machine"));
  }
  if (kill(server->pid, SIGTERM) != 0 && errno != ESRCH) {
    return absl::ErrnoToStatus(errno, absl::StrCat("cannot stop the server in ", folder));
  }
  const bool ended = Await(timeout, [&] {
    const auto now = FindServer(folder);
    // A server that ends empties the file before it releases the lock.
    return !now || (now->pid != 0 && now->pid != server->pid);
  });
  if (ended) return absl::OkStatus();
  return absl::DeadlineExceededError(
      absl::StrCat("the server in ", folder, " (process ", server->pid, ") is still stopping"));
}

}  // namespace ballpiston::client
