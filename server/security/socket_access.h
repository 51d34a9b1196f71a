// Who may open a Unix socket: the mode and the group of its file.
//
//   0600  the server's own user, and root, who can open every file
//   0660  also the members of the group
//   0666  every user of this machine
//
// Users also need access to the folders of the path. With every mode the kernel names the user who
// connects (peer_user.h).
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace ballpiston::server {

struct SocketAccess {
  mode_t mode = 0600;
  std::optional<gid_t> group = {};  // empty: the server's own group

  bool IsOpenToOthers() const { return mode != 0600; }
};

// The group of --socket-group, given by name or number. INVALID_ARGUMENT if there is no such group.
absl::StatusOr<gid_t> FindGroup(const std::string& group);

// Sets the group of a socket's file, which has mode 0600, and then its mode. In this order no user
// can connect before the group is set. Does not follow links. INVALID_ARGUMENT names the flag.
absl::Status SetSocketAccess(const std::string& path, const SocketAccess& access);

}  // namespace ballpiston::server
