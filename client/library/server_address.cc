#include "client/library/server_address.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <cstdint>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

bool IsPort(absl::string_view text) {
  uint32_t port = 0;
  return absl::SimpleAtoi(text, &port) && port >= 1 && port <= 65535;
}

bool IsHost(absl::string_view text) {
  if (absl::ConsumePrefix(&text, "[")) return text.size() > 1 && absl::EndsWith(text, "]");
  return !text.empty() && text.find_first_of(":/[] \t") == absl::string_view::npos;
}

}  // namespace

bool IsSocketPath(absl::string_view path) {
  return !path.empty() && path.size() <= kMaxSocketPath &&
         path.find_first_of("#?,%") == absl::string_view::npos;
}

absl::StatusOr<std::string> GrpcTarget(absl::string_view address) {
  absl::string_view path = address;
  const bool is_socket = absl::ConsumePrefix(&path, "unix:");
  if (is_socket && IsSocketPath(path)) return std::string(address);
  const size_t colon = address.rfind(':');
  const bool is_tcp = !is_socket && colon != address.npos && IsHost(address.substr(0, colon)) &&
                      IsPort(address.substr(colon + 1));
  if (is_tcp) return absl::StrCat("dns:///", address);
  return absl::InvalidArgumentError(absl::StrCat(
      Quoted(address), " is not a server's address: write host:port or unix:PATH (a port is 1 to ",
      "65535, and the path of a socket has at most ", kMaxSocketPath,
      " bytes and none of the characters # ? , %)"));
}

std::string LiteralAddress(absl::string_view address) {
  if (absl::ConsumePrefix(&address, "localhost:")) return absl::StrCat("127.0.0.1:", address);
  return std::string(address);
}

bool IsLoopback(absl::string_view address) {
  absl::string_view host = address.substr(0, address.rfind(':'));
  in_addr v4{};
  if (inet_pton(AF_INET, std::string(host).c_str(), &v4) == 1) {
    return ntohl(v4.s_addr) >> 24 == 127;
  }
  if (!absl::ConsumePrefix(&host, "[") || !absl::ConsumeSuffix(&host, "]")) return false;
  in6_addr v6{};
  return inet_pton(AF_INET6, std::string(host).c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

}  // namespace ballpiston::client
