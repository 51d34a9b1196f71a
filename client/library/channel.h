// Channels to a server, with settings that suit a long watch.
//
// While the server is unreachable, the channel retries calls for about a second if they are safe to
// repeat: all calls but Delete (Create and Cancel carry a request id). If the server says how long
// to wait before a retry, gRPC waits so long. The channel does not retry a watch: JobWatch does.
#pragma once

#include <grpcpp/grpcpp.h>

#include <memory>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/library/channel_security.h"

namespace ballpiston::client {

// Does not connect yet. INVALID_ARGUMENT if `address` is not an address (server_address.h); also
// the errors of CheckSecurity and CredentialsOf (channel_security.h).
absl::StatusOr<std::shared_ptr<grpc::Channel>> OpenChannel(absl::string_view address,
                                                           const ChannelSecurity& security = {});

}  // namespace ballpiston::client
