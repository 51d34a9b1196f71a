// The frame of every unary call: leaves gRPC's thread, runs the method, answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
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

// An exception of the method (out of memory) ends the call, not the server.
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

// The memory of a call until gRPC has sent its answer.
class UnaryReactor : public grpc::ServerUnaryReactor {
 public:
  explicit UnaryReactor(ServiceContext& service) : service_(service) {}

  // RESOURCE_EXHAUSTED  TOO_MANY_CALLS
  absl::Status Hold(const std::string& principal, size_t bytes_of_request) {
    const auto bytes = static_cast<int64_t>(bytes_of_request);
    const absl::Status held =
        service_.executor.held_calls().Begin(principal, bytes, service_.limits);
    if (held.ok()) principal_ = principal;
    if (held.ok()) bytes_ = bytes;
    return held;
  }

  void HoldAnswer(size_t bytes) {
    service_.executor.held_calls().AddBytes(*principal_, static_cast<int64_t>(bytes));
    bytes_ += static_cast<int64_t>(bytes);
  }

  // Also called when the client has disconnected.
  void OnDone() override {
    if (principal_) service_.executor.held_calls().End(*principal_, bytes_);
    delete this;
  }

 private:
  ServiceContext& service_;
  std::optional<std::string> principal_;
  int64_t bytes_ = 0;
};

template <typename Request, typename Response>
void RunAndFinish(UnaryMethod<Request, Response> method, ServiceContext& service, const Call& call,
                  const Request& request, Response& response, UnaryReactor& reactor) {
  const absl::Status room =
      service.executor.held_calls().CheckRoom(call.caller.name, service.limits);
  const grpc::Status status =
      room.ok() ? Answer(method, service, call, request, response) : GrpcStatus(room);
  reactor.HoldAnswer(response.ByteSizeLong());
  reactor.Finish(status);  // may delete the reactor
}

template <typename Request, typename Response>
grpc::ServerUnaryReactor* RunUnary(ServiceContext& service, grpc::CallbackServerContext* context,
                                   const CallRule& rule, const Request* request, Response* response,
                                   UnaryMethod<Request, Response> method) {
  auto* reactor = new UnaryReactor(service);  // owns itself until gRPC calls OnDone
  absl::StatusOr<Call> call = AdmitCall(service, *context, rule);
  absl::Status admitted = call.status();
  // Answered on this thread, because all threads for writes may be waiting for the disk.
  if (admitted.ok() && rule.writes && service.store.stalled()) {
    admitted = StoreFailure(absl::UnavailableError("store: the disk does not answer"));
  }
  if (admitted.ok()) admitted = reactor->Hold(call->caller.name, request->ByteSizeLong());
  if (!admitted.ok()) {
    reactor->Finish(GrpcStatus(admitted));
    return reactor;
  }
  const std::string caller = call->caller.name;
  // gRPC keeps request and response until Finish.
  auto run = [&service, request, response, reactor, method, call = *std::move(call),
              active = service.activity.Begin()] {
    RunAndFinish(method, service, call, *request, *response, *reactor);
  };
  if (rule.writes) {
    service.executor.PostOfWrite(caller, std::move(run));
  } else {
    service.executor.Post(caller, std::move(run));
  }
  return reactor;
}

}  // namespace ballpiston::server
