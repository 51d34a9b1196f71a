// Which server a verb talks to: --server, else BALLPISTON_SERVER, else the private one; and how it
// is known to be that server, and the user to be the user: --ca, --tls, --cert, --key,
// --token-file, each else the variable BALLPISTON_CA, ..._TLS, ..._CERT, ..._KEY, ..._TOKEN_FILE,
// at last BALLPISTON_TOKEN. Over a Unix socket, the private server's too, the variables mean
// nothing. There is no flag for the token itself: every user of a machine sees the others' command
// lines.
#ifndef BALLPISTON_CLIENT_COMMAND_CONNECTION_H_
#define BALLPISTON_CLIENT_COMMAND_CONNECTION_H_

#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/command/exit_code.h"
#include "client/library/channel_security.h"
#include "client/library/local_server.h"

namespace CLI {
class App;
}

namespace ballpiston::client {

struct ServerFlag {
  std::string address;       // of --server; empty: not given
  ChannelSecurity security;  // of the other flags

  void AddTo(CLI::App& verb);
  // Whether it can be an address, and goes together with the rest; connects to nothing.
  absl::Status Check() const;
  // As they were given, for a hint at another command; "" or " --server ...".
  std::string Text() const;
};

struct Connection {
  std::string address;
  std::shared_ptr<grpc::Channel> channel;
  std::optional<LocalServer> local;  // set if it is the private server
  std::string flag;                  // " --server ADDRESS ..." if that was given: for hints
  ChannelSecurity security;          // what the channel was made with

  // Starts the private server again if it is gone; with a named server nothing to do.
  absl::Status Revive() const;

  // What `call` answers. A private server may be leaving, idle, just as the client arrives, or be
  // killed: then it is started again and asked once more. So `call` has to be one that may be
  // repeated.
  template <typename Call>
  auto Ask(const Call& call) const -> decltype(call());

 private:
  static absl::Status StatusOf(const absl::Status& status) { return status; }
  template <typename Value>
  static absl::Status StatusOf(const absl::StatusOr<Value>& value) {
    return value.status();
  }
};

// Connects, runs `verb`, and names the server in the error if it did not answer.
absl::StatusOr<ExitCode> WithServer(
    const ServerFlag& flag, const std::function<absl::StatusOr<ExitCode>(const Connection&)>& verb);

// The same for a verb that only looks: a private server is not started for it. `verb` does without
// Connection::Ask, which would.
absl::StatusOr<ExitCode> WithRunningServer(
    const ServerFlag& flag, const std::function<absl::StatusOr<ExitCode>(const Connection&)>& verb);

template <typename Call>
auto Connection::Ask(const Call& call) const -> decltype(call()) {
  auto answer = call();
  if (!local || !absl::IsUnavailable(StatusOf(answer))) return answer;
  if (absl::Status revived = Revive(); !revived.ok()) return revived;
  return call();
}

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_CONNECTION_H_
