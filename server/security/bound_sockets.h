// Sockets that listen at an address: a Unix socket, or one for each address that a HOST stands for,
// all at one port. The kernel queues connections until they are accepted.
//
// The file of a Unix socket has mode 0600 from the moment it exists until it gets the group and the
// mode that are asked for. Close removes the file only if it is still the same file, because
// another server may have replaced it. No other process can share the port. gRPC gives such a file
// the mode of the umask, and removes it even if it is another server's (socket_listener.h tells why
// gRPC and systemd do not listen here).
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/listen_address.h"
#include "server/security/socket_access.h"

namespace ballpiston::server {

class BoundSockets {
 public:
  // FAILED_PRECONDITION if the sockets cannot listen there, for instance because the address is in
  // use. Only a Unix socket uses `access`, with the errors of SetSocketAccess. Of the addresses
  // that a name stands for, those that this machine does not have are left out.
  static absl::StatusOr<BoundSockets> Bind(const ListenAddress& address,
                                           const SocketAccess& access = {});

  BoundSockets(BoundSockets&& other) noexcept;
  BoundSockets& operator=(BoundSockets&& other) = delete;
  ~BoundSockets() { Close(); }

  const std::vector<int>& descriptors() const { return descriptors_; }  // non-blocking
  int port() const { return port_; }                                    // 0: a Unix socket

  void Close();  // may be called more than once

 private:
  BoundSockets() = default;

  absl::Status BindPath(const ListenAddress& address, const SocketAccess& access);
  absl::Status BindHost(const ListenAddress& address);

  std::vector<int> descriptors_;
  int port_ = 0;
  std::string path_;  // of the socket's file; empty: none
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

}  // namespace ballpiston::server
