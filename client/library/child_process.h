// Starting other programs: servers, the scripts of figures.
//
// A child starts with no signal blocked or ignored and with no file open but the standard three,
// whatever this program has set up for itself.
#ifndef BALLPISTON_CLIENT_LIBRARY_CHILD_PROCESS_H_
#define BALLPISTON_CLIENT_LIBRARY_CHILD_PROCESS_H_

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace ballpiston::client {

struct ChildProcess {
  std::vector<std::string> command;  // the program's path or name (then sought in PATH), arguments
  std::string folder;                // to run in; empty: this program's
  std::string output;      // file that standard output and error are appended to; empty: inherited
  bool detached = false;   // in its own session, so that Ctrl-C here does not reach it
  bool own_group = false;  // in its own group, so that a signal also reaches its children
};

// The path of a program in the folder of this one, whether it is there or not.
std::string ProgramBeside(const std::string& name);

// NOT_FOUND if there is no such program.
absl::StatusOr<pid_t> StartChild(const ChildProcess& child);

// Empty while it runs; afterwards, once, its exit status (128 + signal if one killed it).
std::optional<int> ExitStatus(pid_t pid);

// Waits for its end; its exit status likewise.
absl::StatusOr<int> WaitForChild(pid_t pid);

// Starts it and waits.
absl::StatusOr<int> RunChild(const ChildProcess& child);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_LIBRARY_CHILD_PROCESS_H_
