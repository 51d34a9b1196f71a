#include "client/web/page_access.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

constexpr char kScheme[] = "http://";

// Compares in a time that does not depend on the position of the first difference.
bool AreEqual(absl::string_view a, absl::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

// Browsers omit the default port 80.
std::string WithPort(const char* host, int port) {
  return port == 80 ? host : absl::StrCat(host, ":", port);
}

}  // namespace

PageAccess::PageAccess(int port, std::string token)
    : address_(WithPort("127.0.0.1", port)),
      localhost_(WithPort("localhost", port)),
      token_(std::move(token)) {}

absl::Status PageAccess::CheckOrigin(absl::string_view host, absl::string_view origin) const {
  if (host != address_ && host != localhost_) {
    return absl::PermissionDeniedError(absl::StrCat(
        "Host: ", Quoted(host), " is not this page; permitted: ", address_, ", ", localhost_));
  }
  if (origin.empty() || origin == kScheme + address_ || origin == kScheme + localhost_) {
    return absl::OkStatus();
  }
  return absl::PermissionDeniedError(absl::StrCat("Origin: ", Quoted(origin),
                                                  " is another page; permitted: ", kScheme,
                                                  address_, ", ", kScheme, localhost_));
}

absl::Status PageAccess::CheckToken(absl::string_view authorization) const {
  if (AreEqual(authorization, absl::StrCat("Bearer ", token_))) return absl::OkStatus();
  return absl::UnauthenticatedError(
      authorization.empty()
          ? "the header Authorization: Bearer TOKEN is missing; the token is in the address that "
            "ballpiston web printed"
          : "wrong token: each run of ballpiston web prints an address with a new token");
}

std::string PageAccess::Url() const { return absl::StrCat(kScheme, address_, "/#token=", token_); }

}  // namespace ballpiston::client
