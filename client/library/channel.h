// Channels to a server, set up the way a long watch needs them.
//
// Calls that are safe to repeat (all but Delete; Create and Cancel carry a request id) are retried
// for about a second while the server is unreachable. Watches are not: JobWatch does it itself.
#ifndef BALLPISTON_CLIENT_LIBRARY_CHANNEL_H_
#define BALLPISTON_CLIENT_LIBRARY_CHANNEL_H_

#include <grpcpp/grpcpp.h>

#include <memory>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/library/channel_security.h"

namespace ballpiston::client {

// Does not connect yet. INVALID_ARGUMENT for what is not an address (server_address.h), and errors
// as CheckSecurity's and CredentialsOf's (channel_security.h).
absl::StatusOr<std::shared_ptr<grpc::Channel>> OpenChannel(absl::string_view address,
                                                           const ChannelSecurity& security = {});

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_LIBRARY_CHANNEL_H_
