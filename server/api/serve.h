// The frames of every unary call and of every stream: admit the caller, run the method, answer.
// gRPC gives each call a thread of its own.
#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <optional>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "grpcpp/server_context.h"
#include "server/api/call.h"
#include "server/api/service_context.h"
#include "server/convert/errors.h"

namespace ballpiston::server {

// An exception (out of memory) ends the call, not the server.
inline absl::Status WithoutExceptions(absl::FunctionRef<absl::Status()> run) {
  try {
    return run();
  } catch (const std::exception& error) {
    return WithReason(absl::InternalError(error.what()), "INTERNAL");
  }
}

template <typename Request, typename Response>
using UnaryMethod = absl::StatusOr<Response> (*)(ServiceContext&, const Call&, const Request&);

// The call counts until gRPC has sent its answer (CallObserver::Keep). A call that waits for the
// disk takes no turn.
//   RESOURCE_EXHAUSTED  TOO_MANY_CALLS
//   CANCELLED           the client left before the method began
template <typename Request, typename Response>
grpc::Status ServeUnary(ServiceContext& service, grpc::ServerContext& context, const CallRule& rule,
                        const Request& request, Response& response,
                        UnaryMethod<Request, Response> method) {
  const auto run = [&]() -> absl::Status {
    const std::shared_ptr<void> active = service.activity.Begin();
    const absl::StatusOr<Call> call = AdmitCall(service, context, rule);
    if (!call.ok()) return call.status();
    if (rule.writes && service.store.stalled()) {
      return StoreFailure(absl::UnavailableError("store: the disk does not answer"));
    }
    const auto open =
        service.open_calls.Begin(call->caller.name, static_cast<int64_t>(request.ByteSizeLong()));
    if (!open.ok()) return open.status();
    service.calls.Keep(context, *open);
    std::optional<Turns::Turn> turn;
    if (!rule.writes) turn.emplace(service.turns, call->caller.name);
    if (context.IsCancelled()) return absl::CancelledError("the client is gone");
    absl::StatusOr<Response> answer = method(service, *call, request);
    if (!answer.ok()) return answer.status();
    response = *std::move(answer);
    (*open)->AddBytes(static_cast<int64_t>(response.ByteSizeLong()));
    return absl::OkStatus();
  };
  return GrpcStatus(WithoutExceptions(run));
}

// `run` sends the messages; its status ends the stream.
//   RESOURCE_EXHAUSTED  TOO_MANY_STREAMS
inline grpc::Status ServeStream(ServiceContext& service, grpc::ServerContext& context,
                                const CallRule& rule,
                                absl::FunctionRef<absl::Status(Stream& stream)> run) {
  const auto admit_and_run = [&]() -> absl::Status {
    const std::shared_ptr<void> active = service.activity.Begin();
    const absl::StatusOr<Call> call = AdmitCall(service, context, rule);
    if (!call.ok()) return call.status();
    Stream stream(service.streams, context, call->caller);
    if (absl::Status added = service.streams.Add(stream); !added.ok()) return added;
    return run(stream);
  };
  return GrpcStatus(WithoutExceptions(admit_and_run));
}

}  // namespace ballpiston::server
