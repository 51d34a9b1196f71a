#include "server/door/listen_address.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
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
                         kMaxSocketPath, " (choose a shorter one with --listen or --data-dir)"));
}

bool IsIpv4(const std::string& host) {
  in_addr address{};
  return inet_pton(AF_INET, host.c_str(), &address) == 1;
}

bool IsIpv6(const std::string& host) {
  in6_addr address{};
  return inet_pton(AF_INET6, host.c_str(), &address) == 1;
}

bool IsOfName(unsigned char c) {
  return absl::ascii_isalnum(c) || c == '-' || c == '.' || c == '_';
}

// A name must not end in a number, because programs may read it as an address: 127.1 means
// 127.0.0.1 to some.
bool IsName(const std::string& host) {
  const std::string last = host.substr(host.find_last_of('.') + 1);
  return host.size() <= kLongestName && !last.empty() &&
         std::all_of(host.begin(), host.end(), &IsOfName) &&
         !absl::ascii_isdigit(static_cast<unsigned char>(last.front()));
}

// The name localhost could also mean ::1, where another user's server may listen.
absl::StatusOr<std::string> ParseHost(const std::string& text, const std::string& host) {
  if (host == "localhost") return "127.0.0.1";
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

// 0 if a connection succeeds, otherwise its errno. Does not wait for a busy server.
int ErrorOfConnecting(const std::string& path) {
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return errno;
  sockaddr_un local{};
  local.sun_family = AF_UNIX;
  std::memcpy(local.sun_path, path.data(), std::min(path.size(), kMaxSocketPath));
  const bool connected =
      connect(descriptor, reinterpret_cast<const sockaddr*>(&local), sizeof(local)) == 0;
  const int error = connected ? 0 : errno;
  close(descriptor);
  return error;
}

}  // namespace

std::string ListenAddress::Text() const {
  if (!socket_path.empty()) return absl::StrCat("unix:", socket_path);
  if (host.find(':') != std::string::npos) return absl::StrCat("[", host, "]:", port);
  return absl::StrCat(host, ":", port);
}

bool ListenAddress::IsLoopback() const {
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

absl::Status CheckSocketIsFree(const ListenAddress& address) {
  const int error = ErrorOfConnecting(address.socket_path);
  if (error == ENOENT || error == ECONNREFUSED) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("--listen=", address.Text(),
                   ": a server is listening there (stop it), or the path cannot be used (",
                   std::strerror(error == 0 ? EADDRINUSE : error), "); choose another path"));
}

}  // namespace ballpiston::server
