// One call: who makes it, and the id by which it is found in the log.
#ifndef BALLPISTON_SERVER_API_CALL_H_
#define BALLPISTON_SERVER_API_CALL_H_

#include <string>

#include "absl/status/statusor.h"
#include "grpcpp/server_context.h"
#include "server/api/service_context.h"
#include "server/security/principal.h"

namespace ballpiston::server {

struct Call {
  std::string method;      // CreateEnsembleJob
  std::string request_id;  // the client's `x-request-id`, or one made here
  Principal caller;
};

// What may be done by whom, by method.
struct CallRule {
  const char* method;
  Role least;
  bool writes = false;  // waits for the disk
};

// Quick: for gRPC's own threads. Sends the id back in the trailing metadata, whatever the outcome.
//   FAILED_PRECONDITION  CLIENT_VERSION_NOT_SERVED
//   UNAUTHENTICATED    CREDENTIALS_MISSING, CREDENTIALS_INVALID, CREDENTIALS_EXPIRED
//   PERMISSION_DENIED  ROLE_TOO_LOW
absl::StatusOr<Call> AdmitCall(const ServiceContext& service, grpc::CallbackServerContext& context,
                               const CallRule& rule);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_CALL_H_
