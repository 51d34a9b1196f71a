// Where a server listens: a Unix socket, or a loopback address. This version has no TLS, so an
// address that other machines can reach is refused.
#ifndef BALLPISTON_SERVER_LISTEN_ADDRESS_H_
#define BALLPISTON_SERVER_LISTEN_ADDRESS_H_

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace ballpiston::server {

struct ListenAddress {
  std::string socket_path;  // of a Unix socket; empty for host:port
  std::string host;         // without brackets
  int port = 0;             // 0: any that is free

  // As gRPC and clients write it.
  std::string Text() const;
};

// unix:PATH, HOST:PORT, [::1]:PORT; a HOST in 127.0.0.0/8, ::1 or localhost. INVALID_ARGUMENT
// names the flag --listen, the value, and what is permitted.
absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& text);

// Takes away a socket file that no server listens on any more. FAILED_PRECONDITION if a server
// does, or if the file is no socket.
absl::Status ClearSocketPath(const ListenAddress& address);

// Why nobody can listen there, for a message; found out by trying. Empty if it is not known.
std::string WhyNotListening(const ListenAddress& address);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_LISTEN_ADDRESS_H_
