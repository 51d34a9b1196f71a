// Finds the principal of a call. Looks up its bearer token, or without a token the client's
// certificate, in the access list. The Unix user of a connection (unix_users.h) needs no list.
//
//   authorization: Bearer TOKEN    in the call's metadata; once
//
// If a call has a token and a certificate, the token decides. Each call is looked up again, so a
// new list applies from the next call on, also on existing connections. A watch repeats the look-up
// once per heartbeat. Thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "grpcpp/security/auth_context.h"
#include "grpcpp/server_context.h"
#include "server/mutex.h"
#include "server/security/access_list.h"
#include "server/security/principal.h"

namespace ballpiston::server {

// The credentials of a call.
struct Credentials {
  std::vector<std::string> authorization;   // every such header
  std::optional<std::string> common_name;   // of a verified certificate
  std::optional<Principal> unix_user = {};  // with the role that it has without a list
};

class Authenticator {
 public:
  // Without authentication: every caller is this principal.
  explicit Authenticator(Principal everybody = LocalPrincipal())
      : everybody_(std::move(everybody)) {}
  // With a null list, every Unix user is the principal of that name, and all other callers are
  // rejected.
  explicit Authenticator(std::shared_ptr<const AccessList> list) : list_(std::move(list)) {}

  // UNAUTHENTICATED, reason CREDENTIALS_MISSING, CREDENTIALS_INVALID or CREDENTIALS_EXPIRED. The
  // server's own user and root, whose role is admin, need no entry in the list.
  absl::StatusOr<Principal> Authenticate(const grpc::ServerContextBase& context) const;
  absl::StatusOr<Principal> Authenticate(const Credentials& shown, absl::Time now) const;

  // No effect without authentication.
  void Replace(std::shared_ptr<const AccessList> list);

 private:
  std::shared_ptr<const AccessList> list() const;

  const std::optional<Principal> everybody_ = {};  // empty: callers are authenticated
  mutable Mutex mutex_;
  std::shared_ptr<const AccessList> list_ ABSL_GUARDED_BY(mutex_);
};

// The common name of the client's certificate; empty if the connection has none.
std::optional<std::string> CommonNameOf(const grpc::AuthContext& context);

// The Unix user of a connection, with the role submit or admin (unix_users.h). It is set once,
// before the connection's first call. Other connections have no user.
void SetUnixUser(grpc::AuthContext& context, const Principal& user);
std::optional<Principal> UnixUserOf(const grpc::AuthContext& context);

// The token of a header's value, `Bearer TOKEN`; empty if the value has another form.
absl::string_view BearerToken(absl::string_view authorization);

}  // namespace ballpiston::server
