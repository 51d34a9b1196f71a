// The address of a server as users write it.
//
//   host:port    TCP; an IPv6 host in brackets, [::1]:50051
//   unix:PATH    a Unix domain socket
//
// channel_security.h protects connections to host:port.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {

// The longest path a Unix socket may have, in bytes (sun_path holds 108 on Linux).
inline constexpr size_t kMaxSocketPath = 100;

// Whether gRPC can use the path: it is not too long, and has none of # ? , %, because gRPC reads
// unix:PATH as a URI.
bool IsSocketPath(absl::string_view path);

// The target string that gRPC needs. INVALID_ARGUMENT, with the form of an address, if `address` is
// not an address.
absl::StatusOr<std::string> GrpcTarget(absl::string_view address);

// The address with 127.0.0.1 instead of the name localhost. The name could also mean ::1, where
// another user's server may listen.
std::string LiteralAddress(absl::string_view address);

// Whether only programs of this machine can listen at the address: host 127.x.x.x or
// [::1], in any spelling.
bool IsLoopback(absl::string_view address);

}  // namespace ballpiston::client
