// Authenticates calls of gRPC's own services: reflection, and every other service that is not the
// project's, needs the same credentials as the project's calls. This check lets two kinds pass:
//
//   /grpc.health.v1.Health/...   probes have no token, and learn only whether the server serves
//   /ballpiston.v1....           the frame of these calls asks the Authenticator, and its errors
//                                have a reason (an error from this check cannot have one)
//
// Only for encrypted connections: gRPC has no such processor for others. Thread-safe.
#pragma once

#include "absl/strings/string_view.h"
#include "grpcpp/security/auth_metadata_processor.h"
#include "server/security/authenticator.h"

namespace ballpiston::server {

class OtherServicesCheck : public grpc::AuthMetadataProcessor {
 public:
  // `authenticator` must outlive this.
  explicit OtherServicesCheck(const Authenticator& authenticator) : authenticator_(authenticator) {}

  bool IsBlocking() const override { return false; }
  grpc::Status Process(const InputMetadata& metadata, grpc::AuthContext* context,
                       OutputMetadata* consumed, OutputMetadata* response) override;

 private:
  const Authenticator& authenticator_;
};

// Whether this check lets calls of the method, /PACKAGE.SERVICE/METHOD, pass.
bool PassesUnchecked(absl::string_view method);

}  // namespace ballpiston::server
