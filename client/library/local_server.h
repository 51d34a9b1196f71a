// The private server of one user. The client starts it when needed, so that a job runs on a new
// machine with one command.
//
// The server keeps its jobs, its log and its socket in $XDG_STATE_HOME/ballpiston or
// ~/.local/state/ballpiston; only the user can read this folder. The client connects to the socket.
// If no server answers, the client starts `ballpistond` there, detached, and waits until it
// answers. The server stops when it has been idle for a minute.
//
// Two clients that start at the same time may start two servers. Only the server that gets the
// folder's lock stays, and both clients use it: they wait for at most a minute while it holds the
// lock, unless it listens at another address.
#pragma once

#include <grpcpp/grpcpp.h>

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace ballpiston::client {

struct LocalServer {
  std::string folder;   // data and log
  std::string socket;   // IsSocketPath (server_address.h)
  std::string program;  // what to start (server_process.h)
  // The longest wait for a server that runs but does not answer.
  absl::Duration start_time = absl::Minutes(1);

  std::string Address() const { return "unix:" + socket; }
};

// HOME if it is an absolute path, else the home in the user's entry of the system; empty: neither.
std::string HomeFolder();

// $XDG_STATE_HOME/ballpiston or ~/.local/state/ballpiston: what this user's servers keep.
std::string StateFolder();

// Reads the environment: XDG_STATE_HOME, HOME, TMPDIR, BALLPISTON_SERVER_PROGRAM (else
// `ballpistond` beside this program, else in PATH). Creates the folders. If gRPC cannot use a
// socket in the state folder (IsSocketPath), the socket is in a private folder in $TMPDIR or /tmp.
// PERMISSION_DENIED if a folder is another user's or others can write to it, or the error from
// creating a folder.
absl::StatusOr<LocalServer> FindLocalServer();

// Starts the server if needed, and returns a channel on which the server answers. UNAVAILABLE, with
// the last line of its log, if the server does not answer; INVALID_ARGUMENT or PERMISSION_DENIED if
// it cannot start, for instance because its store is of another version (StartServer).
absl::StatusOr<std::shared_ptr<grpc::Channel>> ConnectToLocalServer(const LocalServer& server);

// The same, but starts no server: UNAVAILABLE if no server answers.
absl::StatusOr<std::shared_ptr<grpc::Channel>> ConnectIfRunning(const LocalServer& server);

}  // namespace ballpiston::client
