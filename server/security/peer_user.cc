#include "server/security/peer_user.h"

#include <sys/socket.h>
#include <unistd.h>

namespace ballpiston::server {

std::optional<uid_t> PeerUser(int descriptor) {
  ucred peer{};
  socklen_t size = sizeof(peer);
  if (getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return std::nullopt;
  // What the kernel gives for a socket without such a peer, as of TCP.
  if (peer.uid == static_cast<uid_t>(-1)) return std::nullopt;
  return peer.uid;
}

std::set<uid_t> OwnUserAndRoot() { return {geteuid(), 0}; }

bool MayConnect(std::optional<uid_t> peer, const std::set<uid_t>& permitted) {
  return peer && permitted.count(*peer) > 0;
}

}  // namespace ballpiston::server
