#include "client/library/connection_hint.h"

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::client {
namespace {

std::string HintWithTls(const ChannelSecurity& security, absl::string_view message) {
  if (absl::StrContains(message, "certificate verify failed")) {
    return absl::StrCat(
        "the server's certificate is not valid now, or was not signed by an authority ",
        security.ca.empty() ? "that this system knows" : "in " + security.ca,
        ": name the right authority with --ca FILE");
  }
  if (absl::StrContains(message, "is not in peer certificate")) {
    return "the server's certificate is for another host: write the host as in the certificate";
  }
  if (absl::StrContains(message, "wrong version number") ||
      absl::StrContains(message, "packet length too long")) {
    return "the server does not use TLS: leave out --ca and --tls";
  }
  return "";
}

bool WasClosed(absl::string_view message) {
  return absl::StrContains(message, "Socket closed") ||
         absl::StrContains(message, "Connection reset");
}

std::string HintWithoutTls(absl::string_view message) {
  if (!WasClosed(message)) return "";
  return "if the server uses TLS: --ca FILE, or --tls if this system knows its authority";
}

}  // namespace

std::string ConnectionHint(const ChannelSecurity& security, absl::string_view message) {
  const std::string hint =
      security.HasTls() ? HintWithTls(security, message) : HintWithoutTls(message);
  return hint.empty() ? "" : absl::StrCat("\n  ", hint);
}

std::string SocketHint(absl::string_view message) {
  if (!WasClosed(message) && !absl::StrContains(message, "Permission denied")) return "";
  return "\n  perhaps it is another user's server: only its own user can open a Unix socket; the "
         "users of a machine share a server at a loopback address, each with a token";
}

}  // namespace ballpiston::client
