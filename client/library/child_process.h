// Starts other programs: servers, the Python package, and commands of the user.
//
// A child process does not inherit this program's signal settings or open files: it starts with no
// signal blocked, and with only the three standard files open. Of the signals that end a program it
// ignores only SIGHUP, and only if this program ignores SIGHUP (nohup).
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace ballpiston::client {

struct ChildProcess {
  std::vector<std::string> command;  // the program's path, or its name in PATH; then the arguments
  std::string folder = {};           // the working folder; empty: this program's
  std::string output = {};  // standard output and error are appended to this file; empty: inherited
  bool detached = false;    // runs in its own session, so that Ctrl-C here does not reach it
  bool own_group = false;   // runs in its own group, so that a signal also reaches its children
  std::string without = {};  // the environment variable that the child does not inherit
};

// The path that a program has if it is in this program's folder. The file need not exist.
std::string ProgramBeside(const std::string& name);

// NOT_FOUND if the program does not exist.
absl::StatusOr<pid_t> StartChild(const ChildProcess& child);

inline constexpr int kUnknownStatus = -1;

// Empty while the child runs. After its end the first call returns its exit status, or 128 + the
// number of the signal that killed it. Later calls return kUnknownStatus, and so does the first if
// this program ignores SIGCHLD: the system then keeps no status.
std::optional<int> ExitStatus(pid_t pid);

// Waits for the child's end. Returns its exit status, as ExitStatus does.
absl::StatusOr<int> WaitForChild(pid_t pid);

// Starts the child and waits for its end.
absl::StatusOr<int> RunChild(const ChildProcess& child);

}  // namespace ballpiston::client
