// The principal of a call, and its role. Pure functions.
#pragma once

#include <string>

namespace ballpiston::server {

// Each role includes the previous ones. kRead: read one's own jobs. kSubmit: also create and end
// them. kAdmin: the same for the jobs of all principals.
enum class Role { kRead, kSubmit, kAdmin };

struct Principal {
  std::string name;
  Role role = Role::kRead;

  bool MaySee(const std::string& owner) const { return role == Role::kAdmin || name == owner; }
};

// read, submit or admin.
inline const char* RoleName(Role role) {
  return role == Role::kRead ? "read" : role == Role::kSubmit ? "submit" : "admin";
}

// The principal of all who connect over a Unix socket that only the server's user and root can
// open. It is also the principal of all who connect over the loopback of a server without
// credentials, with the role of --loopback-role.
inline Principal LocalPrincipal(Role role = Role::kAdmin) { return {"local", role}; }

}  // namespace ballpiston::server
