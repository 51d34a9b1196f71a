// The frames of every unary call and of every stream, within that of every call (call.h).
// gRPC gives each call a thread of its own.
#pragma once

#include <cstdint>
#include <optional>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "grpcpp/server_context.h"
#include "server/api/call.h"
#include "server/api/service_context.h"
#include "server/convert/errors.h"

namespace ballpiston::server {

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
  return ServeCall(service, context, rule, [&](const Call& call) -> absl::Status {
    if (rule.writes && service.store.stalled()) {
      return StoreFailure(absl::UnavailableError("store: the disk does not answer"));
    }
    const auto open =
        service.open_calls.Begin(call.caller.name, static_cast<int64_t>(request.ByteSizeLong()));
    if (!open.ok()) return open.status();
    service.calls.Keep(context, *open);
    std::optional<Turns::Turn> turn;
    if (!rule.writes) turn.emplace(service.turns, call.caller.name);
    if (context.IsCancelled()) return absl::CancelledError("the client is gone");
    absl::StatusOr<Response> answer = method(service, call, request);
    if (!answer.ok()) return answer.status();
    response = *std::move(answer);
    (*open)->AddBytes(static_cast<int64_t>(response.ByteSizeLong()));
    return absl::OkStatus();
  });
}

// `run` sends the messages; its status ends the stream.
//   RESOURCE_EXHAUSTED  TOO_MANY_STREAMS
inline grpc::Status ServeStream(ServiceContext& service, grpc::ServerContext& context,
                                const CallRule& rule,
                                absl::FunctionRef<absl::Status(Stream& stream)> run) {
  return ServeCall(service, context, rule, [&](const Call& call) -> absl::Status {
    Stream stream(service.streams, context, call.caller);
    const absl::Status added = service.streams.Add(stream);
    return added.ok() ? run(stream) : added;
  });
}

}  // namespace ballpiston::server
