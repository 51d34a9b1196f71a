// A ballpistond on this machine, known by its data folder (server/store/data_directory.h): start
// it, find it, stop it.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace ballpiston::client {

struct ServerProgram {
  std::string program;  // what to start: a path, or a name to look up in PATH
  std::string folder;   // an absolute path: data and log
  std::vector<std::string> flags;
  std::string run_in = "/";  // "/" keeps no folder in use; empty: this program's folder

  std::string Log() const { return folder + "/server.log"; }
};

// BALLPISTON_SERVER_PROGRAM, else the `ballpistond` beside this program, else the one in PATH.
std::string UsualServerProgram();

// The server that holds the folder, even if it does not answer.
struct RunningServer {
  pid_t pid = 0;        // 0: not known yet, or on another machine
  std::string address;  // empty: it does not listen yet
};
std::optional<RunningServer> FindServer(const std::string& folder);

// Starts the server, detached, with its output in the log. Waits until it listens, and returns its
// address. If another server was started in the folder at the same time, returns the address of
// that one. An error names the program, says whether it has ended or does not answer, and shows the
// last line that it wrote and the log's path. INVALID_ARGUMENT for wrong flags, PERMISSION_DENIED
// for a folder that the server is not permitted to use, else UNAVAILABLE.
absl::StatusOr<std::string> StartServer(const ServerProgram& program,
                                        absl::Duration timeout = absl::Minutes(1));

// Sends SIGTERM and waits for the server's end. UNAVAILABLE if no server holds the folder;
// DEADLINE_EXCEEDED if the server is still running after `timeout`.
absl::Status StopServer(const std::string& folder, absl::Duration timeout = absl::Minutes(1));

}  // namespace ballpiston::client
