// Where a server listens: a Unix socket, or HOST:PORT. What an address needs in the way of
// credentials is told by security/server_security.h.
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

  // Whether only this machine reaches it: 127.0.0.0/8, ::1, or the name localhost. Other names are
  // taken for addresses that others reach, whatever they stand for today.
  bool IsLoopback() const;
};

// unix:PATH, or HOST:PORT; a HOST is an IPv4 address, an IPv6 address in brackets (with a zone
// where it is of a link, [fe80::1%eth0]), or a name. 0.0.0.0 and [::] both mean every address of
// this machine, of either kind. INVALID_ARGUMENT names the flag --listen, the value, and what is
// permitted.
absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& text);

// Takes away a socket file that no server listens on any more, which is one that refuses
// connections. FAILED_PRECONDITION if a server does, if that cannot be told, or if the file is no
// socket; then the file stays.
absl::Status ClearSocketPath(const ListenAddress& address);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_LISTEN_ADDRESS_H_
