#include "server/listen_address.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

constexpr size_t kMaxSocketPath = sizeof(sockaddr_un{}.sun_path) - 1;

absl::Status Refused(const std::string& text, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat(
      "--listen=", text, ": ", why,
      "; permitted: unix:PATH, or HOST:PORT with a host of 127.0.0.0/8, [::1] or localhost"));
}

absl::StatusOr<ListenAddress> ParseSocket(const std::string& text, const std::string& path) {
  ListenAddress address;
  address.socket_path = path;
  if (path.empty()) return Refused(text, "the path is empty");
  if (path.size() <= kMaxSocketPath) return address;
  return Refused(
      text, absl::StrCat("the path has ", path.size(), " bytes, a Unix socket's at most ",
                         kMaxSocketPath, " (choose a shorter one with --listen or --data_dir)"));
}

bool IsLoopback(const std::string& host) {
  if (host == "localhost") return true;
  in_addr v4{};
  if (inet_pton(AF_INET, host.c_str(), &v4) == 1) return ntohl(v4.s_addr) >> 24 == 127;
  in6_addr v6{};
  return inet_pton(AF_INET6, host.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

// An open socket and its address, as the system wants it.
struct Endpoint {
  explicit Endpoint(const ListenAddress& address) {
    if (!address.socket_path.empty()) {
      auto* local = reinterpret_cast<sockaddr_un*>(&storage);
      local->sun_family = AF_UNIX;
      const size_t length = std::min(address.socket_path.size(), kMaxSocketPath);
      std::memcpy(local->sun_path, address.socket_path.data(), length);
      size = sizeof(sockaddr_un);
    } else if (address.host.find(':') != std::string::npos) {
      auto* v6 = reinterpret_cast<sockaddr_in6*>(&storage);
      v6->sin6_family = AF_INET6;
      v6->sin6_port = htons(static_cast<uint16_t>(address.port));
      inet_pton(AF_INET6, address.host.c_str(), &v6->sin6_addr);
      size = sizeof(sockaddr_in6);
    } else {
      auto* v4 = reinterpret_cast<sockaddr_in*>(&storage);
      v4->sin_family = AF_INET;
      v4->sin_port = htons(static_cast<uint16_t>(address.port));
      const bool named = address.host == "localhost";
      inet_pton(AF_INET, named ? "127.0.0.1" : address.host.c_str(), &v4->sin_addr);
      size = sizeof(sockaddr_in);
    }
    descriptor = socket(storage.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  }
  ~Endpoint() {
    if (descriptor >= 0) close(descriptor);
  }
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;

  const sockaddr* address() const { return reinterpret_cast<const sockaddr*>(&storage); }

  sockaddr_storage storage{};
  socklen_t size = 0;
  int descriptor = -1;
};

}  // namespace

std::string ListenAddress::Text() const {
  if (!socket_path.empty()) return absl::StrCat("unix:", socket_path);
  if (host.find(':') != std::string::npos) return absl::StrCat("[", host, "]:", port);
  return absl::StrCat(host, ":", port);
}

absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& text) {
  constexpr char kUnix[] = "unix:";
  if (text.rfind(kUnix, 0) == 0) return ParseSocket(text, text.substr(std::strlen(kUnix)));
  const size_t colon = text.rfind(':');
  if (colon == std::string::npos) return Refused(text, "there is no port");
  ListenAddress address;
  address.host = text.substr(0, colon);
  if (address.host.size() > 2 && address.host.front() == '[' && address.host.back() == ']') {
    address.host = address.host.substr(1, address.host.size() - 2);
  } else if (address.host.find(':') != std::string::npos) {
    return Refused(text, "an IPv6 host needs brackets");
  }
  if (!absl::SimpleAtoi(text.substr(colon + 1), &address.port) || address.port < 0 ||
      address.port > 65535) {
    return Refused(text, "the port is not a number from 0 to 65535");
  }
  if (IsLoopback(address.host)) return address;
  return Refused(text, absl::StrCat("\"", address.host,
                                    "\" is not a loopback address, and this "
                                    "version has no TLS to listen on others"));
}

absl::Status ClearSocketPath(const ListenAddress& address) {
  struct stat found {};
  if (lstat(address.socket_path.c_str(), &found) != 0) return absl::OkStatus();
  if (!S_ISSOCK(found.st_mode)) {
    return absl::FailedPreconditionError(absl::StrCat("--listen=", address.Text(),
                                                      ": there is a file there that is no socket; "
                                                      "choose another path"));
  }
  const Endpoint endpoint(address);
  if (connect(endpoint.descriptor, endpoint.address(), endpoint.size) == 0) {
    return absl::FailedPreconditionError(absl::StrCat("--listen=", address.Text(),
                                                      ": a server is listening there; stop it or "
                                                      "choose another path"));
  }
  unlink(address.socket_path.c_str());
  return absl::OkStatus();
}

std::string WhyNotListening(const ListenAddress& address) {
  const Endpoint endpoint(address);
  const int on = 1;
  setsockopt(endpoint.descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  if (bind(endpoint.descriptor, endpoint.address(), endpoint.size) == 0 &&
      listen(endpoint.descriptor, 1) == 0) {
    if (!address.socket_path.empty()) unlink(address.socket_path.c_str());
    return std::string();
  }
  return std::strerror(errno);
}

}  // namespace ballpiston::server
