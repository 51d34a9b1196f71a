#include "server/security/bound_sockets.h"

#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

constexpr int kWaiting = 1024;  // connections in the kernel's queue
// For a port that is free at the first of several addresses and taken at another.
constexpr int kAttempts = 20;

absl::Status CannotListen(const ListenAddress& address, const std::string& why) {
  return absl::FailedPreconditionError(absl::StrCat(
      "--listen=", address.Text(), ": cannot listen there (", why, "); choose another address"));
}

// ---- a Unix socket ----

bool BindTo(int descriptor, const std::string& path) {
  sockaddr_un local{};
  local.sun_family = AF_UNIX;
  std::memcpy(local.sun_path, path.data(), std::min(path.size(), sizeof(local.sun_path) - 1));
  // Linux gives the file the mode that the socket has when it is bound: never open to others.
  return fchmod(descriptor, 0600) == 0 &&
         bind(descriptor, reinterpret_cast<const sockaddr*>(&local), sizeof(local)) == 0;
}

// ---- a host ----

struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size = 0;

  sockaddr* get() { return reinterpret_cast<sockaddr*>(&storage); }
  bool operator==(const SocketAddress& other) const {
    return size == other.size && std::memcmp(&storage, &other.storage, size) == 0;
  }
  // IPv4 and IPv6 addresses have the port at the same place.
  in_port_t& port() { return reinterpret_cast<sockaddr_in*>(&storage)->sin_port; }
  bool IsEvery() const {
    if (storage.ss_family == AF_INET) {
      return reinterpret_cast<const sockaddr_in*>(&storage)->sin_addr.s_addr == INADDR_ANY;
    }
    return IN6_IS_ADDR_UNSPECIFIED(&reinterpret_cast<const sockaddr_in6*>(&storage)->sin6_addr);
  }
};

// The addresses of the host, without duplicates. Empty if the host is not known.
std::vector<SocketAddress> AddressesOf(const ListenAddress& address) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  std::vector<SocketAddress> all;
  const std::string port = absl::StrCat(address.port);
  if (getaddrinfo(address.host.c_str(), port.c_str(), &wanted, &found) != 0) return all;
  for (const addrinfo* one = found; one != nullptr; one = one->ai_next) {
    SocketAddress next;
    next.size = one->ai_addrlen;
    std::memcpy(&next.storage, one->ai_addr, one->ai_addrlen);
    if (std::find(all.begin(), all.end(), next) == all.end()) all.push_back(next);
  }
  freeaddrinfo(found);
  return all;
}

// The address of IPv6, whose socket also accepts IPv4, or of IPv4.
SocketAddress EveryAddress(sa_family_t family, int port) {
  SocketAddress every;  // zeros: every address of either kind
  every.storage.ss_family = family;
  every.size = family == AF_INET6 ? sizeof(sockaddr_in6) : sizeof(sockaddr_in);
  every.port() = htons(static_cast<uint16_t>(port));
  return every;
}

// A listening socket. Negative, with errno, on an error.
int ListenAt(SocketAddress& address) {
  const int type = SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK;
  const int descriptor = socket(address.storage.ss_family, type, 0);
  if (descriptor < 0) return -1;
  const int on = 1, off = 0;
  setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));     // after a restart, at once
  setsockopt(descriptor, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof(off));  // fails for IPv4
  if (bind(descriptor, address.get(), address.size) == 0 && listen(descriptor, kWaiting) == 0) {
    return descriptor;
  }
  const int error = errno;
  close(descriptor);
  errno = error;
  return -1;
}

int PortOf(int descriptor) {
  SocketAddress bound;
  bound.size = sizeof(bound.storage);
  if (getsockname(descriptor, bound.get(), &bound.size) != 0) return 0;
  return ntohs(bound.port());
}

bool IsNotOfThisMachine(int error) { return error == EADDRNOTAVAIL || error == EAFNOSUPPORT; }

struct Listening {
  std::vector<int> descriptors;
  int error = 0;  // why there is no socket

  void Fail(int why) {
    for (const int descriptor : std::exchange(descriptors, {})) close(descriptor);
    error = why;
  }
};

// Listens at each address that this machine has, all at the port of the first.
Listening ListenAtAll(std::vector<SocketAddress> addresses) {
  Listening all;
  int missing = EADDRNOTAVAIL;
  for (SocketAddress& address : addresses) {
    if (!all.descriptors.empty()) {
      address.port() = htons(static_cast<uint16_t>(PortOf(all.descriptors.front())));
    }
    const int descriptor = ListenAt(address);
    if (descriptor >= 0) {
      all.descriptors.push_back(descriptor);
    } else if (IsNotOfThisMachine(errno)) {
      missing = errno;
    } else {
      all.Fail(errno);
      return all;
    }
  }
  if (all.descriptors.empty()) all.Fail(missing);
  return all;
}

// On a machine without IPv6, uses IPv4.
Listening ListenEverywhere(int port) {
  Listening both = ListenAtAll({EveryAddress(AF_INET6, port)});
  return IsNotOfThisMachine(both.error) ? ListenAtAll({EveryAddress(AF_INET, port)}) : both;
}

Listening ListenAtHost(int port, const std::vector<SocketAddress>& addresses) {
  return addresses.front().IsEvery() ? ListenEverywhere(port) : ListenAtAll(addresses);
}

}  // namespace

absl::StatusOr<BoundSockets> BoundSockets::Bind(const ListenAddress& address,
                                                const SocketAccess& access) {
  BoundSockets sockets;
  const absl::Status bound =
      address.socket_path.empty() ? sockets.BindHost(address) : sockets.BindPath(address, access);
  if (!bound.ok()) return bound;
  return sockets;
}

BoundSockets::BoundSockets(BoundSockets&& other) noexcept
    : descriptors_(std::exchange(other.descriptors_, {})),
      port_(other.port_),
      path_(std::exchange(other.path_, {})),
      device_(other.device_),
      inode_(other.inode_) {}

// The socket listens only after the file has its mode, so no user can connect before.
absl::Status BoundSockets::BindPath(const ListenAddress& address, const SocketAccess& access) {
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  struct stat made {};
  if (descriptor >= 0) descriptors_ = {descriptor};
  if (descriptor < 0 || !BindTo(descriptor, address.socket_path) ||
      lstat(address.socket_path.c_str(), &made) != 0) {
    return CannotListen(address, std::strerror(errno));
  }
  path_ = address.socket_path;
  device_ = made.st_dev;
  inode_ = made.st_ino;
  const absl::Status set = SetSocketAccess(path_, access);
  if (!set.ok() || listen(descriptor, kWaiting) == 0) return set;
  return CannotListen(address, std::strerror(errno));
}

absl::Status BoundSockets::BindHost(const ListenAddress& address) {
  const std::vector<SocketAddress> addresses = AddressesOf(address);
  if (addresses.empty()) return CannotListen(address, "no such host");
  Listening listening = ListenAtHost(address.port, addresses);
  for (int i = 1; address.port == 0 && listening.error == EADDRINUSE && i < kAttempts; ++i) {
    listening = ListenAtHost(address.port, addresses);
  }
  if (listening.error != 0) return CannotListen(address, std::strerror(listening.error));
  descriptors_ = std::move(listening.descriptors);
  port_ = PortOf(descriptors_.front());
  return absl::OkStatus();
}

// Removes the file first: while the socket is open, no other file can have its inode number.
void BoundSockets::Close() {
  struct stat found {};
  if (!path_.empty() && lstat(path_.c_str(), &found) == 0 && found.st_dev == device_ &&
      found.st_ino == inode_) {
    unlink(path_.c_str());
  }
  path_.clear();
  for (const int descriptor : std::exchange(descriptors_, {})) close(descriptor);
}

}  // namespace ballpiston::server
