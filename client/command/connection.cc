#include "client/command/connection.h"

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "client/library/channel.h"
#include "client/library/connection_hint.h"
#include "client/library/error_text.h"
#include "client/library/server_address.h"

namespace ballpiston::client {
namespace {

constexpr absl::Duration kReviveTimeout = absl::Seconds(10);

std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string Else(const std::string& flag, const char* variable) {
  return flag.empty() ? Variable(variable) : flag;
}

// The flags, and the environment for what they leave out.
ChannelSecurity Completed(ChannelSecurity security) {
  const std::string tls = Variable("BALLPISTON_TLS");
  security.tls = security.tls || (!tls.empty() && tls != "0");
  security.ca = Else(security.ca, "BALLPISTON_CA");
  security.certificate = Else(security.certificate, "BALLPISTON_CERT");
  security.key = Else(security.key, "BALLPISTON_KEY");
  security.token_file = Else(security.token_file, "BALLPISTON_TOKEN_FILE");
  if (security.token_file.empty()) security.token = Variable("BALLPISTON_TOKEN");
  return security;
}

bool IsSocket(const std::string& address) { return absl::StartsWith(address, "unix:"); }

absl::StatusOr<Connection> ConnectTo(const std::string& address, const ServerFlag& flag) {
  const ChannelSecurity security = IsSocket(address) ? flag.security : Completed(flag.security);
  absl::StatusOr<std::shared_ptr<grpc::Channel>> channel = OpenChannel(address, security);
  if (!channel.ok()) return channel.status();
  return Connection{.address = address,
                    .channel = *channel,
                    .local = {},
                    .flag = flag.Text(),
                    .security = security};
}

// How to come to a private server.
using PrivateWay = absl::StatusOr<std::shared_ptr<grpc::Channel>> (*)(const LocalServer&);

absl::StatusOr<Connection> ConnectPrivately(PrivateWay connect) {
  absl::StatusOr<LocalServer> local = FindLocalServer();
  if (!local.ok()) return local.status();
  absl::StatusOr<std::shared_ptr<grpc::Channel>> channel = connect(*local);
  if (!channel.ok()) return channel.status();
  return Connection{.address = local->Address(),
                    .channel = *channel,
                    .local = *local,
                    .flag = "",
                    .security = {}};
}

absl::StatusOr<Connection> Connect(const ServerFlag& flag, PrivateWay connect) {
  if (!flag.address.empty()) return ConnectTo(flag.address, flag);
  const std::string address = Variable("BALLPISTON_SERVER");
  if (!address.empty()) return ConnectTo(address, flag);
  if (!flag.security.HasTls() && !flag.security.HasToken()) return ConnectPrivately(connect);
  return absl::InvalidArgumentError(
      "the private server needs no TLS and no token; name another one with --server");
}

// An error without a reason did not come from the server but from the way to it.
absl::Status NameServer(const absl::Status& status, const Connection& connection) {
  const bool lost = absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status);
  if (!lost || !ErrorReason(status).empty()) return status;
  const std::string message(status.message());
  return absl::Status(
      status.code(),
      absl::StrCat(
          "no answer from the server at ", connection.address, ": ", message,
          IsSocket(connection.address) ? "" : ConnectionHint(connection.security, message)));
}

using Verb = std::function<absl::StatusOr<ExitCode>(const Connection&)>;

absl::StatusOr<ExitCode> RunOver(const absl::StatusOr<Connection>& connection, const Verb& verb) {
  if (!connection.ok()) return connection.status();
  absl::StatusOr<ExitCode> result = verb(*connection);
  if (!result.ok()) return NameServer(result.status(), *connection);
  return result;
}

}  // namespace

void ServerFlag::AddTo(CLI::App& verb) {
  constexpr char kGroup[] = "Server";
  const auto option = [&](const char* name, std::string& value, const char* text) {
    verb.add_option(name, value, text)->group(kGroup);
  };
  option("--server", address,
         "host:port or unix:PATH; else BALLPISTON_SERVER; else a private server, started when "
         "needed");
  option("--ca", security.ca,
         "TLS: PEM file of the authority that signed the server's certificate; else BALLPISTON_CA");
  verb.add_flag("--tls", security.tls,
                "TLS, by the authorities this system knows; else BALLPISTON_TLS=1")
      ->group(kGroup);
  option("--cert", security.certificate,
         "TLS: PEM file of your certificate, if the server wants one; else BALLPISTON_CERT");
  option("--key", security.key, "PEM file of its key; else BALLPISTON_KEY");
  option("--token-file", security.token_file,
         "file with your token; else BALLPISTON_TOKEN_FILE; else the token in BALLPISTON_TOKEN");
}

absl::Status ServerFlag::Check() const {
  if (address.empty()) return absl::OkStatus();
  absl::Status status = GrpcTarget(address).status();
  if (status.ok()) {
    status = CheckSecurity(IsSocket(address) ? security : Completed(security), address);
  }
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat("--server: ", status.message()));
}

std::string ServerFlag::Text() const {
  std::string text;
  const auto add = [&text](const char* name, const std::string& value) {
    if (!value.empty()) absl::StrAppend(&text, " ", name, " ", value);
  };
  add("--server", address);
  add("--ca", security.ca);
  if (security.tls) text += " --tls";
  add("--cert", security.certificate);
  add("--key", security.key);
  add("--token-file", security.token_file);
  return text;
}

absl::Status Connection::Revive() const {
  if (!local) return absl::OkStatus();
  if (absl::Status started = ConnectToLocalServer(*local).status(); !started.ok()) return started;
  // This channel may still be pausing after its last attempt; a call would fail at once.
  channel->WaitForConnected(absl::ToChronoTime(absl::Now() + kReviveTimeout));
  return absl::OkStatus();
}

absl::StatusOr<ExitCode> WithServer(const ServerFlag& flag, const Verb& verb) {
  return RunOver(Connect(flag, &ConnectToLocalServer), verb);
}

absl::StatusOr<ExitCode> WithRunningServer(const ServerFlag& flag, const Verb& verb) {
  return RunOver(Connect(flag, &ConnectIfRunning), verb);
}

}  // namespace ballpiston::client
