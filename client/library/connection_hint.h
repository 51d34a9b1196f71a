// What to try when no connection comes about. gRPC's texts tell the network's and OpenSSL's side of
// it, and say nothing that a user could do.
#ifndef BALLPISTON_CLIENT_LIBRARY_CONNECTION_HINT_H_
#define BALLPISTON_CLIENT_LIBRARY_CONNECTION_HINT_H_

#include <string>

#include "absl/strings/string_view.h"
#include "client/library/channel_security.h"

namespace ballpiston::client {

// A line of its own, "\n  ...", for an error with this text of gRPC 1.51's (OpenSSL 3's in it);
// empty if nothing is known. Pure.
std::string ConnectionHint(const ChannelSecurity& security, absl::string_view message);

// The same for a Unix socket.
std::string SocketHint(absl::string_view message);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_LIBRARY_CONNECTION_HINT_H_
