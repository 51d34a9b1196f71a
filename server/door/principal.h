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

// The principal of the server's own user. A client is this principal if it can open the server's
// Unix socket, or if it sends the server's own token (own_token.h).
inline Principal LocalPrincipal() { return {"local", Role::kAdmin}; }

}  // namespace ballpiston::server
