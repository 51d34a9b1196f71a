#include "client/command/connection.h"

#include <cstdlib>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "client/library/channel.h"
#include "client/library/error_text.h"

namespace ballpiston::client {
namespace {

absl::StatusOr<Connection> ConnectTo(const std::string& address, const std::string& flag) {
  absl::StatusOr<std::shared_ptr<grpc::Channel>> channel = OpenChannel(address);
  if (!channel.ok()) return channel.status();
  return Connection{.address = address, .channel = *channel, .local = {}, .flag = flag};
}

absl::StatusOr<Connection> ConnectPrivately() {
  absl::StatusOr<LocalServer> local = FindLocalServer();
  if (!local.ok()) return local.status();
  absl::StatusOr<std::shared_ptr<grpc::Channel>> channel = ConnectToLocalServer(*local);
  if (!channel.ok()) return channel.status();
  return Connection{.address = local->Address(), .channel = *channel, .local = *local, .flag = ""};
}

absl::StatusOr<Connection> Connect(const ServerFlag& flag) {
  if (!flag.address.empty()) return ConnectTo(flag.address, " --server " + flag.address);
  const char* variable = std::getenv("BALLPISTON_SERVER");
  if (variable != nullptr && variable[0] != '\0') return ConnectTo(variable, "");
  return ConnectPrivately();
}

// An error without a reason did not come from the server but from the way to it.
absl::Status NameServer(const absl::Status& status, const Connection& connection) {
  const bool lost = absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status);
  if (!lost || !ErrorReason(status).empty()) return status;
  return absl::Status(status.code(), absl::StrCat("no answer from the server at ",
                                                  connection.address, ": ", status.message()));
}

}  // namespace

void ServerFlag::AddTo(CLI::App& verb) {
  verb.add_option("--server", address,
                  "host:port or unix:PATH; else BALLPISTON_SERVER; else a private server, started "
                  "when needed");
}

void Connection::Revive() const {
  if (local) ConnectToLocalServer(*local).IgnoreError();  // the watch reports what goes wrong
}

absl::StatusOr<ExitCode> WithServer(
    const ServerFlag& flag,
    const std::function<absl::StatusOr<ExitCode>(const Connection&)>& verb) {
  absl::StatusOr<Connection> connection = Connect(flag);
  if (!connection.ok()) return connection.status();
  absl::StatusOr<ExitCode> result = verb(*connection);
  if (!result.ok()) return NameServer(result.status(), *connection);
  return result;
}

}  // namespace ballpiston::client
