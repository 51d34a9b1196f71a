// One call: its caller, and the frames around its method. gRPC gives each call a thread of its own.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "grpcpp/server_context.h"
#include "server/convert/errors.h"
#include "server/door/principal.h"
#include "server/rpc/service_context.h"

namespace ballpiston::server {

struct Call {
  std::string method;  // CreateEnsembleJob
  Principal caller;
  // Whether the client has left or its deadline has passed. PlanEnsembleJob asks before each point.
  std::function<bool()> is_abandoned = [] { return false; };
};

// Logs what the call has done to a job. `points`: of its grid, if they are to be logged.
void LogDone(const Call& call, const char* what, const std::string& job,
             const std::string& points = "");

// The least role that a method needs.
struct CallRule {
  const char* method;
  Role least;
  bool writes = false;  // waits for the disk
};

// The frame of every call: authenticates and authorises it, runs its method, and reports a failure
// to the log. An exception (out of memory) ends the call, not the server.
//   FAILED_PRECONDITION  CLIENT_VERSION_NOT_SERVED
//   UNAUTHENTICATED      CREDENTIALS_MISSING, CREDENTIALS_INVALID, CREDENTIALS_EXPIRED
//   PERMISSION_DENIED    ROLE_TOO_LOW
//   INTERNAL             an exception
grpc::Status ServeCall(ServiceContext& service, grpc::ServerContext& context, const CallRule& rule,
                       absl::FunctionRef<absl::Status(const Call&)> method);

// The frame of a unary call, within that of every call. The call counts until gRPC has sent its
// answer (CallObserver::Keep).
//   RESOURCE_EXHAUSTED  TOO_MANY_CALLS
//   CANCELLED           the client left while the method planned
template <typename Request, typename Response>
grpc::Status ServeUnary(ServiceContext& service, grpc::ServerContext& context, const CallRule& rule,
                        const Request& request, Response& response,
                        absl::StatusOr<Response> (*method)(ServiceContext&, const Call&,
                                                           const Request&)) {
  return ServeCall(service, context, rule, [&](const Call& call) -> absl::Status {
    if (rule.writes && service.store.stalled()) {
      return StoreFailure(absl::UnavailableError("store: the disk does not answer"));
    }
    const auto part =
        service.quotas.calls.Take(call.caller.name, MibOfCall(request.ByteSizeLong()));
    if (!part.ok()) return part.status();
    service.calls.Keep(context, *part);
    absl::StatusOr<Response> answer = method(service, call, request);
    if (!answer.ok()) return answer.status();
    response = *std::move(answer);
    return absl::OkStatus();
  });
}

// The frame of a stream, within that of every call. `run` sends the messages; its status ends the
// stream.
//   RESOURCE_EXHAUSTED  TOO_MANY_STREAMS
grpc::Status ServeStream(ServiceContext& service, grpc::ServerContext& context,
                         const CallRule& rule, absl::FunctionRef<absl::Status(Stream&)> run);

}  // namespace ballpiston::server
