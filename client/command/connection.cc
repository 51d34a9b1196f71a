#include "client/command/connection.h"

#include <algorithm>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "client/command/verb_table.h"
#include "client/library/channel.h"
#include "client/library/connection_hint.h"
#include "client/library/error_text.h"

namespace ballpiston::client {
namespace {

constexpr absl::Duration kReviveTimeout = absl::Seconds(10);

bool IsSocket(const std::string& address) { return absl::StartsWith(address, "unix:"); }

bool HasSecurityFlags(const Options& options) {
  return std::any_of(ServerFlags().flags.begin(), ServerFlags().flags.end(), [&](const Flag& flag) {
    const std::string name = LongName(flag);
    return name != "--server" && options.given.contains(name);
  });
}

absl::StatusOr<Connection> ConnectTo(const std::string& address, const Options& options) {
  const bool none = IsSocket(address) && !HasSecurityFlags(options);
  const ChannelSecurity security = none ? ChannelSecurity() : options.security;
  auto channel = OpenChannel(address, security);
  if (!channel.ok()) {
    return absl::Status(channel.status().code(),
                        absl::StrCat("--server: ", channel.status().message()));
  }
  return Connection{.address = address,
                    .channel = *channel,
                    .client = Client(*channel),
                    .local = {},
                    .flags = options.connection,
                    .security = security};
}

// Connects to a private server: starts it, or only finds it.
using PrivateWay = absl::StatusOr<std::shared_ptr<grpc::Channel>> (*)(const LocalServer&);

absl::StatusOr<Connection> ConnectPrivately(PrivateWay connect) {
  absl::StatusOr<LocalServer> local = FindLocalServer();
  if (!local.ok()) return local.status();
  auto channel = connect(*local);
  if (!channel.ok()) return channel.status();
  return Connection{.address = local->Address(),
                    .channel = *channel,
                    .client = Client(*channel),
                    .local = *local,
                    .flags = "",
                    .security = {}};
}

absl::StatusOr<Connection> Connect(const Options& options, PrivateWay connect) {
  if (!options.server.empty()) return ConnectTo(options.server, options);
  if (!HasSecurityFlags(options)) return ConnectPrivately(connect);
  return absl::InvalidArgumentError(
      "the private server uses neither TLS nor a token; name another server with --server");
}

VerbResult RunOver(const absl::StatusOr<Connection>& connection, const Terminal& terminal,
                   const VerbOfServer& verb) {
  if (!connection.ok()) return connection.status();
  terminal.Detail(absl::StrCat("server ", connection->address));
  VerbResult result = verb(*connection);
  return result.ok() ? result : NameServer(result.status(), *connection);
}

}  // namespace

absl::Status Connection::Revive() const {
  if (!local) return absl::OkStatus();
  if (absl::Status started = ConnectToLocalServer(*local).status(); !started.ok()) return started;
  // After a failed attempt this channel pauses. A call during the pause would fail at once.
  channel->WaitForConnected(absl::ToChronoTime(absl::Now() + kReviveTimeout));
  return absl::OkStatus();
}

// An error without a reason is an error of the connection; the server's errors have a reason.
absl::Status NameServer(const absl::Status& status, const Connection& connection) {
  const bool lost = absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status);
  if (!lost || !ErrorReason(status).empty()) return status;
  const std::string message(status.message());
  return absl::Status(
      status.code(),
      absl::StrCat("no answer from the server at ", connection.address, ": ", message,
                   IsSocket(connection.address) ? SocketHint(message)
                                                : ConnectionHint(connection.security, message)));
}

absl::Status WithHint(const absl::Status& status, absl::string_view hint) {
  absl::Status with_hint(status.code(), absl::StrCat(status.message(), "\n", hint));
  status.ForEachPayload([&](absl::string_view type, const absl::Cord& payload) {
    with_hint.SetPayload(type, payload);
  });
  return with_hint;
}

absl::Status HintIfExpired(const absl::Status& status, const Connection& connection,
                           const std::string& job) {
  if (ErrorReason(status) != "RESULTS_EXPIRED") return status;
  return WithHint(status, absl::StrCat("To compute them again: ballpiston submit --again ", job,
                                       connection.flags));
}

VerbResult WithServer(const Options& options, const Terminal& terminal, const VerbOfServer& verb) {
  return RunOver(Connect(options, &ConnectToLocalServer), terminal, verb);
}

VerbResult WithRunningServer(const Options& options, const Terminal& terminal,
                             const VerbOfServer& verb) {
  return RunOver(Connect(options, &ConnectIfRunning), terminal, verb);
}

}  // namespace ballpiston::client
