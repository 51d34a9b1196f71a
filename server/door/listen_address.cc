#include "server/door/listen_address.h"

#include <sys/socket.h>
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
      "; permitted: unix:PATH, or HOST:PORT with an IPv4 address, an IPv6 address in brackets, or "
      "a name as the host"));
}

absl::StatusOr<ListenAddress> ParseSocket(const std::string& text, const std::string& path) {
  ListenAddress address;
  address.socket_path = path;
  if (path.empty()) return Refused(text, "the path is empty");
  constexpr char kChoose[] = " (choose another path with --listen or --data-dir)";
  if (path.size() > kMaxSocketPath) {
    return Refused(text, absl::StrCat("the path has ", path.size(),
                                      " bytes, a Unix socket's at most ", kMaxSocketPath, kChoose));
  }
  if (path.find_first_of("#?,%") == std::string::npos) return address;
  return Refused(text, absl::StrCat("gRPC cannot use a path with # ? , or %", kChoose));
}

// Whether the text may be a host. The client has the same rule (client/library/server_address.cc).
// A host without brackets has no colon: a colon would make it an IPv6 address, or gRPC's own syntax
// (ipv4:, dns:).
bool IsHost(const std::string& host) {
  if (host.starts_with('[')) return host.size() > 2 && host.ends_with(']');
  return !host.empty() && host.find_first_of(":/[] \t") == std::string::npos;
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
  return absl::StrCat(host, ":", port);
}

bool ListenAddress::IsLoopback() const { return host == "127.0.0.1" || host == "[::1]"; }

absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& text) {
  constexpr char kUnix[] = "unix:";
  if (text.rfind(kUnix, 0) == 0) return ParseSocket(text, text.substr(std::strlen(kUnix)));
  const size_t colon = text.rfind(':');
  if (colon == std::string::npos) return Refused(text, "there is no port");
  ListenAddress address;
  address.host = text.substr(0, colon);
  if (!IsHost(address.host)) return Refused(text, "the host is not valid");
  // The name could also mean ::1, where another user's server may listen.
  if (address.host == "localhost") address.host = "127.0.0.1";
  if (!absl::SimpleAtoi(text.substr(colon + 1), &address.port) || address.port < 0 ||
      address.port > 65535) {
    return Refused(text, "the port is not a number from 0 to 65535");
  }
  return address;
}

absl::Status CheckSocketIsFree(const ListenAddress& address) {
  const int error = ErrorOfConnecting(address.socket_path);
  if (error == ENOENT || error == ECONNREFUSED) return absl::OkStatus();
  return absl::UnavailableError(
      absl::StrCat("--listen=", address.Text(),
                   ": a server is listening there (stop it), or the path cannot be used (",
                   std::strerror(error == 0 ? EADDRINUSE : error), "); choose another path"));
}

}  // namespace ballpiston::server
