// The server that a verb uses: --server, else BALLPISTON_SERVER or the config file, else the
// private server (library/local_server.h).
//
// A Unix socket, such as the private server's, uses neither TLS nor tokens. Flags of TLS and tokens
// are then an error; the same settings in the environment and the config file are ignored.
#pragma once

#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "client/command/options.h"
#include "client/command/verbs.h"
#include "client/library/client.h"

namespace ballpiston::client {

struct Connection {
  std::string address;
  std::shared_ptr<grpc::Channel> channel;
  Client client;             // over the channel; starts a private server again
  std::string flags;         // for hints: " --server ADDRESS ..." if given
  ChannelSecurity security;  // of the channel
};

// Adds the server's address to an error of the connection. Does not change the server's own errors.
absl::Status NameServer(const absl::Status& status, const Connection& connection);

// The same error with the same details, and the hint for the user on a separate line.
absl::Status WithHint(const absl::Status& status, absl::string_view hint);

// If the results of the job have expired, adds the command that computes them again. Returns any
// other status unchanged.
absl::Status HintIfExpired(const absl::Status& status, const Connection& connection,
                           const std::string& job);

using VerbOfServer = std::function<VerbResult(const Connection&)>;

// Connects and runs `verb`. If the server does not answer, the error names the server.
VerbResult WithServer(const Options& options, const Terminal& terminal, const VerbOfServer& verb);

// The same, but does not start a private server, for a verb that only shows the state of a server.
VerbResult WithRunningServer(const Options& options, const Terminal& terminal,
                             const VerbOfServer& verb);

}  // namespace ballpiston::client
