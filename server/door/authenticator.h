// Finds the principal of a call: looks up its bearer token in the access list.
//
//   authorization: Bearer TOKEN    in the call's metadata; once
//
// Each call is looked up again, so a new list applies from the next call on, also on existing
// connections. A watch repeats the look-up once per heartbeat. Thread-safe.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "grpcpp/server_context.h"
#include "server/door/access_list.h"
#include "server/door/principal.h"
#include "server/mutex.h"

namespace ballpiston::server {

class Authenticator {
 public:
  // Without tokens every caller is LocalPrincipal(): only the server's user and root can open its
  // Unix socket.
  explicit Authenticator(bool needs_tokens) : needs_tokens_(needs_tokens) {}

  // UNAUTHENTICATED, reason CREDENTIALS_MISSING, CREDENTIALS_INVALID or CREDENTIALS_EXPIRED.
  absl::StatusOr<Principal> Authenticate(const grpc::ServerContextBase& context) const;
  // `authorization`: every header of this name.
  absl::StatusOr<Principal> Authenticate(const std::vector<std::string>& authorization,
                                         absl::Time now) const;

  void Accept(AccessList list);  // instead of the previous list

 private:
  const bool needs_tokens_;
  mutable Mutex mutex_;
  AccessList list_ ABSL_GUARDED_BY(mutex_);
};

// The token of a header's value, `Bearer TOKEN`; empty if the value has another form.
absl::string_view BearerToken(absl::string_view authorization);

}  // namespace ballpiston::server
