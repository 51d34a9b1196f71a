// The server that a verb uses: --server, else BALLPISTON_SERVER or the config file, else the
// private server (library/local_server.h).
//
// A Unix socket, such as the private server's, uses neither TLS nor tokens. Flags of TLS and tokens
// are then an error; the same settings in the environment and the config file are ignored.
#pragma once

#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/clock.h"
#include "client/command/options.h"
#include "client/command/verbs.h"
#include "client/library/client.h"
#include "client/library/error_text.h"
#include "client/library/local_server.h"

namespace ballpiston::client {

struct Connection {
  std::string address;
  std::shared_ptr<grpc::Channel> channel;
  Client client;                     // over the channel
  std::optional<LocalServer> local;  // set for the private server
  std::string flags;                 // for hints: " --server ADDRESS ..." if given
  ChannelSecurity security;          // of the channel

  // Restarts the private server if it has stopped. Does nothing for a named server.
  absl::Status Revive() const;

  // Returns the result of `call`. If the private server has just stopped because it was idle, or
  // was killed, restarts the server and retries once: therefore `call` must be safe to repeat.
  template <typename Call>
  auto Ask(const Call& call) const -> decltype(call()) {
    auto answer = call();
    if (!local || !absl::IsUnavailable(answer.status())) return answer;
    absl::SleepFor(RetryDelay(answer.status()));
    if (absl::Status revived = Revive(); !revived.ok()) return revived;
    return call();
  }
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
// `verb` must not call Connection::Ask, which can start the server.
VerbResult WithRunningServer(const Options& options, const Terminal& terminal,
                             const VerbOfServer& verb);

}  // namespace ballpiston::client
