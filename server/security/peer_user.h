// Whose process is at the other end of a Unix socket. The kernel tells; it cannot be forged.
#ifndef BALLPISTON_SERVER_SECURITY_PEER_USER_H_
#define BALLPISTON_SERVER_SECURITY_PEER_USER_H_

#include <sys/types.h>

#include <optional>
#include <set>
#include <string>

namespace ballpiston::server {

// The user the peer had when it connected; nothing if the descriptor is not such a socket.
std::optional<uid_t> PeerUser(int descriptor);

// This process's own, and root, whom no permission keeps out anyway.
std::set<uid_t> OwnUserAndRoot();

// A peer whose user is not known is nobody's.
bool MayConnect(std::optional<uid_t> peer, const std::set<uid_t>& permitted);

// Whether the number stands for one user. If the server runs in a user namespace (PrivateUsers= of
// systemd, a container), the kernel reports one number for all users of other namespaces, that of
// `nobody`. They must not share their jobs.
bool StandsForOneUser(std::optional<uid_t> peer);

// The name in the system's list of users; none if the user is not in the list, or if the list
// cannot be read now. May wait for a directory service.
std::optional<std::string> UserName(uid_t user);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_PEER_USER_H_
