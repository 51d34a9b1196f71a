// The user of the process at the other end of a Unix socket. The kernel provides it; clients cannot
// forge it.
#pragma once

#include <sys/types.h>

#include <optional>
#include <set>
#include <string>

namespace ballpiston::server {

// The peer's user at the time of the connection; empty if the descriptor is not a Unix socket.
std::optional<uid_t> PeerUser(int descriptor);

// This process's user, and root, who has access in any case.
std::set<uid_t> OwnUserAndRoot();

// Whether the peer is permitted. False if its user is not known.
bool MayConnect(std::optional<uid_t> peer, const std::set<uid_t>& permitted);

// Whether the number stands for one user. If the server runs in a user namespace (PrivateUsers= of
// systemd, a container), the kernel reports one number for all users of other namespaces, that of
// `nobody`. They must not share their jobs.
bool StandsForOneUser(std::optional<uid_t> peer);

// The name in the system's list of users; empty if the user is not in the list, or if the list
// cannot be read now. May wait for a directory service.
std::optional<std::string> UserName(uid_t user);

}  // namespace ballpiston::server
