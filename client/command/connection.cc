#include "client/command/connection.h"

#include <cstdlib>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "client/library/channel.h"
#include "client/library/error_text.h"
#include "client/library/server_address.h"

namespace ballpiston::client {
namespace {

constexpr absl::Duration kReviveTimeout = absl::Seconds(10);

absl::StatusOr<Connection> ConnectTo(const std::string& address, const std::string& flag) {
  absl::StatusOr<std::shared_ptr<grpc::Channel>> channel = OpenChannel(address);
  if (!channel.ok()) return channel.status();
  return Connection{.address = address, .channel = *channel, .local = {}, .flag = flag};
}

// How to come to a private server.
using PrivateWay = absl::StatusOr<std::shared_ptr<grpc::Channel>> (*)(const LocalServer&);

absl::StatusOr<Connection> ConnectPrivately(PrivateWay connect) {
  absl::StatusOr<LocalServer> local = FindLocalServer();
  if (!local.ok()) return local.status();
  absl::StatusOr<std::shared_ptr<grpc::Channel>> channel = connect(*local);
  if (!channel.ok()) return channel.status();
  return Connection{.address = local->Address(), .channel = *channel, .local = *local, .flag = ""};
}

absl::StatusOr<Connection> Connect(const ServerFlag& flag, PrivateWay connect) {
  if (!flag.address.empty()) return ConnectTo(flag.address, " --server " + flag.address);
  const char* variable = std::getenv("BALLPISTON_SERVER");
  if (variable != nullptr && variable[0] != '\0') return ConnectTo(variable, "");
  return ConnectPrivately(connect);
}

// An error without a reason did not come from the server but from the way to it.
absl::Status NameServer(const absl::Status& status, const Connection& connection) {
  const bool lost = absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status);
  if (!lost || !ErrorReason(status).empty()) return status;
  return absl::Status(status.code(), absl::StrCat("no answer from the server at ",
                                                  connection.address, ": ", status.message()));
}

using Verb = std::function<absl::StatusOr<ExitCode>(const Connection&)>;

absl::StatusOr<ExitCode> Run(const absl::StatusOr<Connection>& connection, const Verb& verb) {
  if (!connection.ok()) return connection.status();
  absl::StatusOr<ExitCode> result = verb(*connection);
  if (!result.ok()) return NameServer(result.status(), *connection);
  return result;
}

}  // namespace

void ServerFlag::AddTo(CLI::App& verb) {
  verb.add_option("--server", address,
                  "host:port or unix:PATH; else BALLPISTON_SERVER; else a private server, started "
                  "when needed");
}

absl::Status ServerFlag::Check() const {
  if (address.empty()) return absl::OkStatus();
  const absl::Status status = GrpcTarget(address).status();
  if (status.ok()) return status;
  return absl::InvalidArgumentError(absl::StrCat("--server: ", status.message()));
}

absl::Status Connection::Revive() const {
  if (!local) return absl::OkStatus();
  if (absl::Status started = ConnectToLocalServer(*local).status(); !started.ok()) return started;
  // This channel may still be pausing after its last attempt; a call would fail at once.
  channel->WaitForConnected(absl::ToChronoTime(absl::Now() + kReviveTimeout));
  return absl::OkStatus();
}

absl::StatusOr<ExitCode> WithServer(const ServerFlag& flag, const Verb& verb) {
  return Run(Connect(flag, &ConnectToLocalServer), verb);
}

absl::StatusOr<ExitCode> WithRunningServer(const ServerFlag& flag, const Verb& verb) {
  return Run(Connect(flag, &ConnectIfRunning), verb);
}

}  // namespace ballpiston::client
