// Who may open a Unix socket: the mode and the group of its file.
//
//   0600  the server's own user, and root, who may open every file
//   0660  the members of the group, too
//   0666  every user of this machine
//
// They also need access to the folders of the path. With every mode the kernel tells who connects
// (peer_user.h).
#ifndef BALLPISTON_SERVER_SECURITY_SOCKET_ACCESS_H_
#define BALLPISTON_SERVER_SECURITY_SOCKET_ACCESS_H_

#include <sys/types.h>

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace ballpiston::server {

struct SocketAccess {
  mode_t mode = 0600;
  std::optional<gid_t> group = {};  // none: the server's own

  bool IsOpenToOthers() const { return mode != 0600; }
};

// The value of --socket-group: a group's name or its number. INVALID_ARGUMENT if there is none.
absl::StatusOr<gid_t> FindGroup(const std::string& group);

// Sets the group of the file of a socket, which has mode 0600, and then its mode. In this order
// nobody can connect before the group is right. Does not follow links. INVALID_ARGUMENT names the
// flag.
absl::Status SetSocketAccess(const std::string& path, const SocketAccess& access);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_SOCKET_ACCESS_H_
