// The door of what gRPC itself serves: reflection, and whatever else is not the project's, needs
// the same credentials as a call. Two things pass:
//
//   /grpc.health.v1.Health/...   a probe has no token, and learns only whether the server serves
//   /ballpiston.v1....           the call's own frame asks the Authenticator, and can say why it
//                                refuses (a refusal from here has no room for a reason)
//
// Only for encrypted connections: gRPC gives others no such processor. Thread-safe.
#ifndef BALLPISTON_SERVER_SECURITY_OTHER_SERVICES_CHECK_H_
#define BALLPISTON_SERVER_SECURITY_OTHER_SERVICES_CHECK_H_

#include "absl/strings/string_view.h"
#include "grpcpp/security/auth_metadata_processor.h"
#include "server/security/authenticator.h"

namespace ballpiston::server {

class OtherServicesCheck : public grpc::AuthMetadataProcessor {
 public:
  // `authenticator` has to outlive it.
  explicit OtherServicesCheck(const Authenticator& authenticator) : authenticator_(authenticator) {}

  bool IsBlocking() const override { return false; }
  grpc::Status Process(const InputMetadata& metadata, grpc::AuthContext* context,
                       OutputMetadata* consumed, OutputMetadata* response) override;

 private:
  const Authenticator& authenticator_;
};

// Whether this check leaves a call of the method, /PACKAGE.SERVICE/METHOD, to others.
bool PassesUnchecked(absl::string_view method);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_OTHER_SERVICES_CHECK_H_
