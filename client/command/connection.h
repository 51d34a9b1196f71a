// The server that a verb talks to: --server, else BALLPISTON_SERVER or the config file, else the
// private one (library/local_server.h).
//
// A Unix socket, such as the private server's, uses no TLS and no tokens: settings from the
// environment and the config file are ignored, and such flags are an error.
#ifndef BALLPISTON_CLIENT_COMMAND_CONNECTION_H_
#define BALLPISTON_CLIENT_COMMAND_CONNECTION_H_

#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/command/options.h"
#include "client/command/verbs.h"
#include "client/library/client.h"
#include "client/library/local_server.h"

namespace ballpiston::client {

struct Connection {
  std::string address;
  std::shared_ptr<grpc::Channel> channel;
  Client client;                     // over the channel
  std::optional<LocalServer> local;  // set if it is the private server
  std::string flags;                 // " --server ADDRESS ..." if they were given: for hints
  ChannelSecurity security;          // what the channel was made with

  // Starts the private server again if it is gone; with a named server nothing to do.
  absl::Status Revive() const;

  // What `call` answers. A private server may be leaving, idle, just as the client arrives, or be
  // killed: then it is started again and asked once more. So `call` has to be one that may be
  // repeated.
  template <typename Call>
  auto Ask(const Call& call) const -> decltype(call()) {
    auto answer = call();
    if (!local || !absl::IsUnavailable(answer.status())) return answer;
    if (absl::Status revived = Revive(); !revived.ok()) return revived;
    return call();
  }
};

// Adds the server's address to an error of the connection. Errors that the server returned stay as
// they are.
absl::Status NameServer(const absl::Status& status, const Connection& connection);

using VerbOfServer = std::function<VerbResult(const Connection&)>;

// Connects, runs `verb`, and names the server in the error if it did not answer.
VerbResult WithServer(const Options& options, const Terminal& terminal, const VerbOfServer& verb);

// The same for a verb that only looks: a private server is not started for it. `verb` does without
// Connection::Ask, which would.
VerbResult WithRunningServer(const Options& options, const Terminal& terminal,
                             const VerbOfServer& verb);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_CONNECTION_H_
