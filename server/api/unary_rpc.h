// The frame of every unary call: leaves gRPC's thread, runs the method, answers.
#ifndef BALLPISTON_SERVER_API_UNARY_RPC_H_
#define BALLPISTON_SERVER_API_UNARY_RPC_H_

#include <exception>
#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "grpcpp/server_context.h"
#include "grpcpp/support/server_callback.h"
#include "server/api/call.h"
#include "server/api/service_context.h"
#include "server/convert/errors.h"

namespace ballpiston::server {

template <typename Request, typename Response>
using UnaryMethod = absl::StatusOr<Response> (*)(ServiceContext&, const Call&, const Request&);

// What the method throws (no memory left) ends the call, not the server.
template <typename Request, typename Response>
grpc::Status Answer(UnaryMethod<Request, Response> method, ServiceContext& service,
                    const Call& call, const Request& request, Response& response) {
  try {
    absl::StatusOr<Response> result = method(service, call, request);
    if (result.ok()) response = *std::move(result);
    return GrpcStatus(result.status());
  } catch (const std::exception& error) {
    return GrpcStatus(WithReason(absl::InternalError(error.what()), "INTERNAL"));
  }
}

template <typename Request, typename Response>
grpc::ServerUnaryReactor* RunUnary(ServiceContext& service, grpc::CallbackServerContext* context,
                                   const CallRule& rule, const Request* request, Response* response,
                                   UnaryMethod<Request, Response> method) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  absl::StatusOr<Call> call = AdmitCall(service, *context, rule);
  if (!call.ok()) {
    reactor->Finish(GrpcStatus(call.status()));
    return reactor;
  }
  // gRPC keeps request and response until Finish.
  service.executor.Post([&service, request, response, reactor, method, call = *std::move(call),
                         active = service.activity.Begin()] {
    reactor->Finish(Answer(method, service, call, *request, *response));
  });
  return reactor;
}

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_UNARY_RPC_H_
