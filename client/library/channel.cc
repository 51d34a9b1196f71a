#include "client/library/channel.h"

#include <string>

#include "absl/strings/string_view.h"
#include "client/library/server_address.h"

namespace ballpiston::client {
namespace {

constexpr int kKeepaliveMilliseconds = 30'000;

// The first entry is the default: retry. The second entry names the methods that must not be
// retried: it has no retry policy, and gRPC prefers it to the default.
constexpr char kServiceConfig[] = R"({"methodConfig": [
  {"name": [{}],
   "retryPolicy": {"maxAttempts": 4, "initialBackoff": "0.1s", "maxBackoff": "1s",
                   "backoffMultiplier": 2, "retryableStatusCodes": ["UNAVAILABLE", "CANCELLED"]}},
  {"name": [
    {"service": "ballpiston.v1.EnsembleService", "method": "WatchEnsembleJob"},
    {"service": "ballpiston.v1.EnsembleService", "method": "DeleteEnsembleJob"}]}
]})";

grpc::ChannelArguments Arguments() {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMilliseconds);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 10'000);
  // A watch only receives. By default gRPC stops sending pings after two of them without data, and
  // would not notice a dead connection.
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  // By default the pauses between attempts to connect grow to two minutes. That is too long for a
  // watch that waits for a server to restart.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 2'000);
  // The web proxy does not lead to a server on this machine or in this laboratory.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetMaxReceiveMessageSize(-1);  // the server limits the size of its answers
  arguments.SetUserAgentPrefix("ballpiston/" BALLPISTON_VERSION);  // the server checks the version
  arguments.SetServiceConfigJSON(kServiceConfig);
  return arguments;
}

}  // namespace

absl::StatusOr<std::shared_ptr<grpc::Channel>> OpenChannel(absl::string_view address,
                                                           const ChannelSecurity& security) {
  const std::string literal = LiteralAddress(address);
  const absl::StatusOr<std::string> target = GrpcTarget(security.HasTls() ? address : literal);
  if (!target.ok()) return target.status();
  if (absl::Status fits = CheckSecurity(security, literal); !fits.ok()) return fits;
  const auto credentials = CredentialsOf(security, literal);
  if (!credentials.ok()) return credentials.status();
  return grpc::CreateCustomChannel(*target, *credentials, Arguments());
}

}  // namespace ballpiston::client
