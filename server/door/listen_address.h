// Where a server listens: a Unix socket, or HOST:PORT. door.h says which credentials each kind
// of address needs.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace ballpiston::server {

struct ListenAddress {
  std::string socket_path;  // of a Unix socket; empty for host:port
  std::string host;         // an IPv6 address has its brackets
  int port = 0;             // 0: any free port

  // The address as gRPC and clients write it.
  std::string Text() const;

  // Whether only local connections are possible: exactly 127.0.0.1 or [::1]. Every other host
  // counts as one that other machines reach.
  bool IsLoopback() const;
};

// Parses unix:PATH or HOST:PORT. PATH has none of # ? , %, because gRPC reads unix:PATH as a URI.
// HOST is an IPv4 address, an IPv6 address in brackets, or a name, which gRPC reads; localhost is
// 127.0.0.1. 0.0.0.0 and [::] both mean every IPv4 and IPv6 address of this machine.
// INVALID_ARGUMENT names the flag --listen, the value, and the permitted values.
absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& text);

// UNAVAILABLE if the socket does not refuse connections, because a server may listen on it. gRPC
// would replace it; other files it leaves alone, and does not start.
absl::Status CheckSocketIsFree(const ListenAddress& address);

}  // namespace ballpiston::server
