#include "server/listen_address.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

constexpr size_t kMaxSocketPath = sizeof(sockaddr_un{}.sun_path) - 1;
constexpr size_t kLongestName = 253;

absl::Status Refused(const std::string& text, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat(
      "--listen=", text, ": ", why,
      "; permitted: unix:PATH, or HOST:PORT with an IPv4 address, an IPv6 address in brackets, or "
      "a name as the host"));
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

bool IsIpv4(const std::string& host) {
  in_addr address{};
  return inet_pton(AF_INET, host.c_str(), &address) == 1;
}

bool IsOfName(unsigned char c) {
  return absl::ascii_isalnum(c) || c == '-' || c == '.' || c == '_';
}

bool IsIpv6(const std::string& host) {
  const size_t percent = host.find('%');
  const std::string zone = percent == std::string::npos ? "none" : host.substr(percent + 1);
  in6_addr address{};
  return inet_pton(AF_INET6, host.substr(0, percent).c_str(), &address) == 1 && !zone.empty() &&
         std::all_of(zone.begin(), zone.end(), &IsOfName);
}

// What ends in a number would be read as an address: 127.1 is 127.0.0.1 to some programs.
bool IsName(const std::string& host) {
  const std::string last = host.substr(host.find_last_of('.') + 1);
  return host.size() <= kLongestName && !last.empty() &&
         std::all_of(host.begin(), host.end(), &IsOfName) &&
         !absl::ascii_isdigit(static_cast<unsigned char>(last.front()));
}

absl::StatusOr<std::string> ParseHost(const std::string& text, const std::string& host) {
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (bracketed) {
    const std::string inner = host.substr(1, host.size() - 2);
    if (IsIpv6(inner)) return inner;
    return Refused(text, "there is no IPv6 address in the brackets");
  }
  if (host.find(':') != std::string::npos) return Refused(text, "an IPv6 host needs brackets");
  if (IsIpv4(host) || IsName(host)) return host;
  return Refused(text, "the host is neither an address nor a name");
}

// A socket that could listen at the address, and the address as the system wants it.
struct Endpoint {
  explicit Endpoint(const ListenAddress& address) {
    if (address.socket_path.empty()) {
      Resolve(address);
    } else {
      auto* local = reinterpret_cast<sockaddr_un*>(&storage);
      local->sun_family = AF_UNIX;
      const size_t length = std::min(address.socket_path.size(), kMaxSocketPath);
      std::memcpy(local->sun_path, address.socket_path.data(), length);
      size = sizeof(sockaddr_un);
    }
    if (size > 0) descriptor = socket(storage.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  }
  ~Endpoint() {
    if (descriptor >= 0) close(descriptor);
  }
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;

  const sockaddr* address() const { return reinterpret_cast<const sockaddr*>(&storage); }

  sockaddr_storage storage{};
  socklen_t size = 0;  // 0: the host is unknown
  int descriptor = -1;

 private:
  // The first address the host stands for.
  void Resolve(const ListenAddress& address) {
    addrinfo wanted{};
    wanted.ai_socktype = SOCK_STREAM;
    wanted.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
    addrinfo* found = nullptr;
    const std::string port = absl::StrCat(address.port);
    if (getaddrinfo(address.host.c_str(), port.c_str(), &wanted, &found) != 0) return;
    std::memcpy(&storage, found->ai_addr, found->ai_addrlen);
    size = found->ai_addrlen;
    freeaddrinfo(found);
  }
};

}  // namespace

std::string ListenAddress::Text() const {
  if (!socket_path.empty()) return absl::StrCat("unix:", socket_path);
  if (host.find(':') != std::string::npos) return absl::StrCat("[", host, "]:", port);
  return absl::StrCat(host, ":", port);
}

bool ListenAddress::IsLoopback() const {
  if (host == "localhost") return true;
  in_addr v4{};
  if (inet_pton(AF_INET, host.c_str(), &v4) == 1) return ntohl(v4.s_addr) >> 24 == 127;
  in6_addr v6{};
  return inet_pton(AF_INET6, host.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& text) {
  constexpr char kUnix[] = "unix:";
  if (text.rfind(kUnix, 0) == 0) return ParseSocket(text, text.substr(std::strlen(kUnix)));
  const size_t colon = text.rfind(':');
  if (colon == std::string::npos) return Refused(text, "there is no port");
  const absl::StatusOr<std::string> host = ParseHost(text, text.substr(0, colon));
  if (!host.ok()) return host.status();
  ListenAddress address;
  address.host = *host;
  if (!absl::SimpleAtoi(text.substr(colon + 1), &address.port) || address.port < 0 ||
      address.port > 65535) {
    return Refused(text, "the port is not a number from 0 to 65535");
  }
  return address;
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
  if (endpoint.size == 0) return "no such host";
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
