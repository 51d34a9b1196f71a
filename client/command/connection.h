// Which server a verb talks to: --server, else BALLPISTON_SERVER, else the private one.
#ifndef BALLPISTON_CLIENT_COMMAND_CONNECTION_H_
#define BALLPISTON_CLIENT_COMMAND_CONNECTION_H_

#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/command/exit_code.h"
#include "client/library/local_server.h"

namespace ballpiston::client {

struct ServerFlag {
  std::string address;  // of --server; empty: not given

  void AddTo(CLI::App& verb);
};

struct Connection {
  std::string address;
  std::shared_ptr<grpc::Channel> channel;
  std::optional<LocalServer> local;  // set if it is the private server
  std::string flag;                  // " --server ADDRESS" if that was given: for hints

  // Starts the private server again if it is gone; with a named server nothing to do.
  void Revive() const;
};

// Connects, runs `verb`, and names the server in the error if it did not answer.
absl::StatusOr<ExitCode> WithServer(
    const ServerFlag& flag, const std::function<absl::StatusOr<ExitCode>(const Connection&)>& verb);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_CONNECTION_H_
