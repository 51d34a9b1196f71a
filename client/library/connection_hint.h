// Advice for a failed connection. The messages of gRPC and OpenSSL describe the failure, but do not
// say what the user can do.
#pragma once

#include <string>

#include "absl/strings/string_view.h"
#include "client/library/channel_security.h"

namespace ballpiston::client {

// A separate line of advice, "\n  ...", for an error with this text of gRPC 1.51 and OpenSSL 3;
// empty if the text is unknown. Pure.
std::string ConnectionHint(const ChannelSecurity& security, absl::string_view message);

// The same for a Unix socket.
std::string SocketHint(absl::string_view message);

}  // namespace ballpiston::client
