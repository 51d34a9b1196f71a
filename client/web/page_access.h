// Who may use the page: other programs of this machine reach the same port, and so do web pages
// from elsewhere that the user's browser shows.
//
//   Host           has to be this page's own address: a foreign name that resolves to this machine
//                  (DNS rebinding) is rejected
//   Origin         where a browser sends one, it has to be this page's
//   Authorization  Bearer TOKEN, on every call to the server; the page itself holds no secrets
#ifndef BALLPISTON_CLIENT_WEB_PAGE_ACCESS_H_
#define BALLPISTON_CLIENT_WEB_PAGE_ACCESS_H_

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

  // The address with the token, which browsers keep to themselves: it is in the fragment.
  std::string Url() const;

 private:
  const std::string address_;    // 127.0.0.1:PORT
  const std::string localhost_;  // localhost:PORT
  const std::string token_;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_WEB_PAGE_ACCESS_H_
