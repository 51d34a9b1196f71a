// The address of a server as users write it.
//
//   host:port    TCP; an IPv6 host in brackets, [::1]:50051
//   unix:PATH    a Unix domain socket
//
// What a connection to host:port is protected by is told by channel_security.h.
#ifndef BALLPISTON_CLIENT_LIBRARY_SERVER_ADDRESS_H_
#define BALLPISTON_CLIENT_LIBRARY_SERVER_ADDRESS_H_

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {

// The longest path a Unix socket may have, in bytes (sun_path holds 108 on Linux).
inline constexpr size_t kMaxSocketPath = 100;

// The target string gRPC wants; INVALID_ARGUMENT tells what an address looks like.
absl::StatusOr<std::string> GrpcTarget(absl::string_view address);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_LIBRARY_SERVER_ADDRESS_H_
