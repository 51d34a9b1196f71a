// Who is calling, as far as the door is concerned.
#ifndef BALLPISTON_SERVER_SECURITY_AUTHENTICATOR_H_
#define BALLPISTON_SERVER_SECURITY_AUTHENTICATOR_H_

#include "absl/status/statusor.h"
#include "grpcpp/server_context.h"
#include "server/security/principal.h"

namespace ballpiston::server {

// The open door: everybody who passes is the local principal.
class Authenticator {
 public:
  absl::StatusOr<Principal> Authenticate(const grpc::ServerContextBase&) const {
    return LocalPrincipal();
  }
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_AUTHENTICATOR_H_
