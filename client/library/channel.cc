#include "client/library/channel.h"

#include <string>

#include "absl/strings/string_view.h"
#include "client/library/server_address.h"

namespace ballpiston::client {
namespace {

constexpr int kKeepaliveMilliseconds = 30'000;

// The second entry has no retry policy, and a method's own entry wins over the default.
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
  // A watch only listens: without this the pings end after two, and a dead connection goes unseen.
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  // gRPC's own pauses between attempts to connect grow to two minutes: too long for a watch that
  // waits for a server to come back.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 2'000);
  // A server on this machine or in this laboratory is not behind the web proxy.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetMaxReceiveMessageSize(-1);  // the server decides how large its answers are
  arguments.SetServiceConfigJSON(kServiceConfig);
  return arguments;
}

}  // namespace

absl::StatusOr<std::shared_ptr<grpc::Channel>> OpenChannel(absl::string_view address,
                                                           const ChannelSecurity& security) {
  const absl::StatusOr<std::string> target = GrpcTarget(address);
  if (!target.ok()) return target.status();
  if (absl::Status fits = CheckSecurity(security, address); !fits.ok()) return fits;
  const auto credentials = CredentialsOf(security);
  if (!credentials.ok()) return credentials.status();
  return grpc::CreateCustomChannel(*target, *credentials, Arguments());
}

}  // namespace ballpiston::client
