#include "client/command/connection.h"

#include <algorithm>
#include <mutex>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/string_view.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "client/command/verb_table.h"
#include "client/library/channel.h"
#include "client/library/channel_security.h"
#include "client/library/error_text.h"
#include "client/library/local_server.h"
#include "client/output/spelling.h"

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

// The client prints `text`, which tells the user what to do, if gRPC's message contains `part`.
struct Hint {
  absl::string_view part;
  std::string text;
};

std::vector<Hint> HintsFor(const std::string& address, const ChannelSecurity& security) {
  const std::string foreign =
      "perhaps it is another user's server: only its own user can open a Unix socket; the users of "
      "a machine share a server at a loopback address, each with a token";
  const std::string use_tls =
      "if the server uses TLS: --ca FILE, or --tls if this system knows its authority";
  const std::string no_tls = "the server does not use TLS: leave out --ca and --tls";
  if (IsSocket(address)) {
    return {
        {"Socket closed", foreign}, {"Connection reset", foreign}, {"Permission denied", foreign}};
  }
  if (!security.HasTls()) return {{"Socket closed", use_tls}, {"Connection reset", use_tls}};
  return {{"certificate verify failed",
           absl::StrCat("the server's certificate is not valid now, or was not signed by an "
                        "authority ",
                        security.ca.empty() ? "that this system knows" : "in " + security.ca,
                        ": name the right authority with --ca FILE")},
          {"is not in peer certificate",
           "the server's certificate is for another host: write the host as in the certificate"},
          {"wrong version number", no_tls},
          {"packet length too long", no_tls}};
}

// The flag whose value the error of OpenChannel is about.
absl::string_view FlagOf(absl::string_view error) {
  if (absl::StartsWith(error, "the token file ")) return "--token-file";
  if (absl::StartsWith(error, "the token ")) return "BALLPISTON_TOKEN";
  return absl::StartsWith(error, "the authority file ") ? "--ca" : "--server";
}

// `options` must have passed CheckServerFlags.
absl::StatusOr<Connection> ConnectTo(const std::string& address, const Options& options) {
  const ChannelSecurity security = IsSocket(address) ? ChannelSecurity() : options.security;
  auto channel = OpenChannel(address, security);
  if (!channel.ok()) {
    return absl::Status(channel.status().code(), absl::StrCat(FlagOf(channel.status().message()),
                                                              ": ", channel.status().message()));
  }
  return Connection{.address = address,
                    .channel = *channel,
                    .client = Client(*channel),
                    .flags = options.connection,
                    .security = security};
}

// A private server stops when it is idle. If several threads find it stopped, only one starts it.
Revival RevivalOf(const LocalServer& server, const std::shared_ptr<grpc::Channel>& channel) {
  return [server, channel, mutex = std::make_shared<std::mutex>()] {
    const std::lock_guard lock(*mutex);
    absl::Status started = ConnectToLocalServer(server).status();
    // After a failed attempt this channel pauses. A call during the pause would fail at once.
    if (started.ok()) channel->WaitForConnected(absl::ToChronoTime(absl::Now() + kReviveTimeout));
    return started;
  };
}

absl::StatusOr<Connection> ConnectPrivately(bool may_start) {
  const absl::StatusOr<LocalServer> server = FindLocalServer();
  if (!server.ok()) return server.status();
  const auto channel = may_start ? ConnectToLocalServer(*server) : ConnectIfRunning(*server);
  if (!channel.ok()) return channel.status();
  return Connection{.address = server->Address(),
                    .channel = *channel,
                    .client = Client(*channel, kCallTimeout,
                                     may_start ? RevivalOf(*server, *channel) : Revival()),
                    .flags = "",
                    .security = {}};
}

absl::StatusOr<Connection> Connect(const Options& options, bool may_start) {
  if (absl::Status bad = CheckServerFlags(options); !bad.ok()) return bad;
  return options.server.empty() ? ConnectPrivately(may_start) : ConnectTo(options.server, options);
}

// ---- jobs ----

absl::Status CheckSelection(const Options& options) {
  if (options.jobs.empty() && options.labels.empty()) {
    return absl::InvalidArgumentError("name a JOB, or give --label KEY=VALUE");
  }
  if (options.jobs.empty() || !options.given.contains("--label")) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "--label and names of jobs exclude each other: give one of them");
}

absl::Status NoneFound(const JobStates& states) {
  const auto spelled = [](std::string* out, v1::EnsembleJob::State state) {
    absl::StrAppend(out, Spelling(state));
  };
  return absl::NotFoundError(absl::StrCat("no job has these labels",
                                          states.empty() ? "" : " and one of the states ",
                                          absl::StrJoin(states, ", ", spelled)));
}

absl::StatusOr<std::vector<v1::EnsembleJob>> SelectedJobs(const Connection& connection,
                                                          const Options& options,
                                                          const JobStates& states) {
  std::vector<v1::EnsembleJob> named;
  for (const std::string& name : options.jobs) named.emplace_back().set_name(name);
  if (!named.empty()) return named;
  v1::ListEnsembleJobsRequest request;
  request.set_view(v1::ListEnsembleJobsRequest::BASIC);
  request.mutable_labels()->insert(options.labels.begin(), options.labels.end());
  for (const auto state : states) request.add_states(state);
  auto jobs = connection.client.List(request);
  if (jobs.ok() && jobs->empty()) return NoneFound(states);
  return jobs;
}

}  // namespace

std::string ConnectionHint(const std::string& address, const ChannelSecurity& security,
                           absl::string_view message) {
  for (const Hint& hint : HintsFor(address, security)) {
    if (absl::StrContains(message, hint.part)) return "\n  " + hint.text;
  }
  return "";
}

absl::Status CheckServerFlags(const Options& options) {
  if (!HasSecurityFlags(options)) return absl::OkStatus();
  if (options.server.empty()) {
    return absl::InvalidArgumentError(
        "the private server uses neither TLS nor a token; name another server with --server");
  }
  if (!IsSocket(options.server)) return absl::OkStatus();
  const absl::Status fits = CheckSecurity(options.security, options.server);
  return fits.ok() ? fits : absl::Status(fits.code(), absl::StrCat("--server: ", fits.message()));
}

// An error without a reason is an error of the connection; the server's errors have a reason.
absl::Status NameServer(const absl::Status& status, const Connection& connection) {
  const bool lost = absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status);
  if (!lost || !ErrorReason(status).empty()) return status;
  const std::string message(status.message());
  return absl::Status(
      status.code(),
      absl::StrCat("no answer from the server at ", connection.address, ": ", message,
                   ConnectionHint(connection.address, connection.security, message)));
}

absl::Status HintIfExpired(const absl::Status& status, const Connection& connection,
                           const std::string& job) {
  if (ErrorReason(status) != "RESULTS_EXPIRED") return status;
  absl::Status with_hint(status.code(),
                         absl::StrCat(status.message(), "\nTo compute them again: ",
                                      "ballpiston submit --again ", job, connection.flags));
  status.ForEachPayload([&](absl::string_view type, const absl::Cord& payload) {
    with_hint.SetPayload(type, payload);
  });
  return with_hint;
}

VerbResult WithServer(const Options& options, const Terminal& terminal, const VerbOfServer& verb,
                      bool may_start) {
  const absl::StatusOr<Connection> connection = Connect(options, may_start);
  if (!connection.ok()) return connection.status();
  terminal.Detail(absl::StrCat("server ", connection->address));
  VerbResult result = verb(*connection);
  return result.ok() ? result : NameServer(result.status(), *connection);
}

VerbResult WithJobs(const Options& options, const Terminal& terminal, const JobStates& states,
                    const VerbOfJobs& verb) {
  if (absl::Status bad = CheckSelection(options); !bad.ok()) return bad;
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const auto jobs = SelectedJobs(connection, options, states);
    if (!jobs.ok()) return jobs.status();
    return verb(connection, *jobs);
  });
}

}  // namespace ballpiston::client
