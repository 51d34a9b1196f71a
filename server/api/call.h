// One call: its caller, its request id, which is also in the log, and the frame around its method.
#pragma once

#include <string>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
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

// Authenticates and authorises a call, runs its method, and reports a failure to the log. Always
// sends the request id back in the trailing metadata. An exception (out of memory) ends the call,
// not the server.
//   FAILED_PRECONDITION  CLIENT_VERSION_NOT_SERVED
//   UNAUTHENTICATED      CREDENTIALS_MISSING, CREDENTIALS_INVALID, CREDENTIALS_EXPIRED
//   PERMISSION_DENIED    ROLE_TOO_LOW
//   INTERNAL             an exception
grpc::Status ServeCall(ServiceContext& service, grpc::ServerContext& context, const CallRule& rule,
                       absl::FunctionRef<absl::Status(const Call&)> method);

}  // namespace ballpiston::server
