// One call: its caller, and its request id, which is also in the log.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "grpcpp/server_context.h"
#include "server/api/service_context.h"
#include "server/door/principal.h"

namespace ballpiston::server {

struct Call {
  std::string method;      // CreateEnsembleJob
  std::string request_id;  // the client's `x-request-id`, or a generated one
  Principal caller;
};

// The least role that a method needs.
struct CallRule {
  const char* method;
  Role least;
  bool writes = false;  // waits for the disk
};

// Authenticates and authorises a call. Always sends the request id back in the trailing metadata.
//   FAILED_PRECONDITION  CLIENT_VERSION_NOT_SERVED
//   UNAUTHENTICATED    CREDENTIALS_MISSING, CREDENTIALS_INVALID, CREDENTIALS_EXPIRED
//   PERMISSION_DENIED  ROLE_TOO_LOW
absl::StatusOr<Call> AdmitCall(const ServiceContext& service, grpc::ServerContext& context,
                               const CallRule& rule);

}  // namespace ballpiston::server
