// Finds the principal of a call. Its bearer token, or else the client's certificate, is looked up
// in the access list. The Unix user of a connection (unix_users.h) needs no list.
//
//   authorization: Bearer TOKEN    in the call's metadata; once
//
// A token that is shown decides, also beside a certificate. Each call is looked up anew, so a list
// that was replaced holds from the next call on, on connections that were there before too; a
// watch that runs asks again now and then. Thread-safe.
#ifndef BALLPISTON_SERVER_SECURITY_AUTHENTICATOR_H_
#define BALLPISTON_SERVER_SECURITY_AUTHENTICATOR_H_

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

// What a call shows for itself.
struct Credentials {
  std::vector<std::string> authorization;   // every such header
  std::optional<std::string> common_name;   // of a certificate that was verified
  std::optional<Principal> unix_user = {};  // with the role that it has without a list
};

class Authenticator {
 public:
  // Without authentication: every caller is this principal.
  explicit Authenticator(Principal everybody = LocalPrincipal())
      : everybody_(std::move(everybody)) {}
  // Without a list every Unix user may call, as the principal of that name, and nobody else.
  explicit Authenticator(std::shared_ptr<const AccessList> list) : list_(std::move(list)) {}

  // UNAUTHENTICATED, reason CREDENTIALS_MISSING, CREDENTIALS_INVALID or CREDENTIALS_EXPIRED. A Unix
  // user whose role is admin, the server's own and root, is not looked up.
  absl::StatusOr<Principal> Authenticate(const grpc::ServerContextBase& context) const;
  absl::StatusOr<Principal> Authenticate(const Credentials& shown, absl::Time now) const;

  // A door that was open stays so.
  void Replace(std::shared_ptr<const AccessList> list);

 private:
  std::shared_ptr<const AccessList> list() const;

  const std::optional<Principal> everybody_ = {};  // none: callers are authenticated
  mutable Mutex mutex_;
  std::shared_ptr<const AccessList> list_ ABSL_GUARDED_BY(mutex_);
};

// The common name of the certificate that the connection was made with, if one was asked for.
std::optional<std::string> CommonNameOf(const grpc::AuthContext& context);

// The Unix user of a connection, with the role submit or admin (unix_users.h). It is set once,
// before the first call goes on. Other connections have none.
void SetUnixUser(grpc::AuthContext& context, const Principal& user);
std::optional<Principal> UnixUserOf(const grpc::AuthContext& context);

// The token of a header's value, `Bearer TOKEN`; empty if it is something else.
absl::string_view BearerToken(absl::string_view authorization);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_AUTHENTICATOR_H_
