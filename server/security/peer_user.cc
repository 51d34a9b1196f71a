#include "server/security/peer_user.h"

#include <pwd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <vector>

namespace ballpiston::server {
namespace {

// The kernel's default for users that are not mapped.
constexpr uid_t kNobody = 65534;

uid_t NumberOfUnmappedUsers() {
  uid_t number = kNobody;
  return std::ifstream("/proc/sys/kernel/overflowuid") >> number ? number : kNobody;
}

}  // namespace

std::optional<uid_t> PeerUser(int descriptor) {
  ucred peer{};
  socklen_t size = sizeof(peer);
  if (getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return std::nullopt;
  // The kernel's value for a socket without a Unix peer, such as TCP.
  if (peer.uid == static_cast<uid_t>(-1)) return std::nullopt;
  return peer.uid;
}

std::set<uid_t> OwnUserAndRoot() { return {geteuid(), 0}; }

bool MayConnect(std::optional<uid_t> peer, const std::set<uid_t>& permitted) {
  return peer && permitted.count(*peer) > 0;
}

bool StandsForOneUser(std::optional<uid_t> peer) {
  static const uid_t unmapped = NumberOfUnmappedUsers();
  return peer && *peer != unmapped;
}

std::optional<std::string> UserName(uid_t user) {
  std::vector<char> buffer(1024);
  passwd entry{};
  passwd* found = nullptr;
  while (getpwuid_r(user, &entry, buffer.data(), buffer.size(), &found) == ERANGE) {
    buffer.resize(2 * buffer.size());
  }
  if (found == nullptr || *found->pw_name == '\0') return std::nullopt;
  return found->pw_name;
}

}  // namespace ballpiston::server
