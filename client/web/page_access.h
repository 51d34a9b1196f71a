// Access control of the page. Other programs on this machine, and web pages of other sites in the
// user's browser, can reach the same port. Three headers of a request are checked:
//
//   Host           must be this page's address. This rejects a foreign name that resolves to this
//                  machine (DNS rebinding).
//   Origin         must be this page's, if the browser sends it
//   Authorization  must be Bearer TOKEN in every call to the server. The page's files contain no
//                  secrets and need no token.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {

class PageAccess {
 public:
  PageAccess(int port, std::string token);

  // PERMISSION_DENIED. `origin` is empty if the request has none.
  absl::Status CheckOrigin(absl::string_view host, absl::string_view origin) const;
  // UNAUTHENTICATED.
  absl::Status CheckToken(absl::string_view authorization) const;

  // The address with the token. The token is in the fragment, which browsers do not send.
  std::string Url() const;

 private:
  const std::string address_;    // 127.0.0.1:PORT
  const std::string localhost_;  // localhost:PORT
  const std::string token_;
};

}  // namespace ballpiston::client
