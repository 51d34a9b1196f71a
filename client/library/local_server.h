// The private server: one command does the job on a fresh machine.
//
// It lives in one folder of the user's, $XDG_STATE_HOME/ballpiston or ~/.local/state/ballpiston,
// readable by nobody else: the jobs, the log, the socket. The client asks at the socket; if nobody
// answers it starts the program `ballpistond` there, detached, and waits until it answers. The
// server stops by itself when it has had nothing to do for a minute.
//
// Two clients that start at once may start two servers; the data folder's lock lets one of them
// live, and both clients end up with that one: they wait for it while it holds the lock, for a
// minute at most, unless it listens elsewhere.
#ifndef BALLPISTON_CLIENT_LIBRARY_LOCAL_SERVER_H_
#define BALLPISTON_CLIENT_LIBRARY_LOCAL_SERVER_H_

#include <grpcpp/grpcpp.h>

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace ballpiston::client {

struct LocalServer {
  std::string folder;   // data and log
  std::string socket;   // at most kMaxSocketPath bytes long
  std::string program;  // what to start (server_process.h)
  // To wait for a server that lives and does not answer.
  absl::Duration start_time = absl::Minutes(1);

  std::string Address() const { return "unix:" + socket; }
};

// From the environment: XDG_STATE_HOME, HOME, TMPDIR, BALLPISTON_SERVER_PROGRAM (else `ballpistond`
// beside this program, else in PATH). Creates the folders. Where the state folder's path is too
// long for a socket, the socket lives in a private folder below $TMPDIR or /tmp.
// PERMISSION_DENIED, or whatever kept a folder from being made.
absl::StatusOr<LocalServer> FindLocalServer();

// A channel on which the server answers. UNAVAILABLE, with the last line of its log, if it cannot
// be brought to.
absl::StatusOr<std::shared_ptr<grpc::Channel>> ConnectToLocalServer(const LocalServer& server);

// The same, but nothing is started: UNAVAILABLE if nobody answers.
absl::StatusOr<std::shared_ptr<grpc::Channel>> ConnectIfRunning(const LocalServer& server);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_LIBRARY_LOCAL_SERVER_H_
