// Unary calls of the ensemble service, for clients whose server is killed.
#pragma once

#include <grpcpp/grpcpp.h>

#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "client/library/error_text.h"
#include "tests/support/preamble.h"

namespace ballpiston::torture {

using Stub = v1::EnsembleService::Stub;

constexpr std::chrono::seconds kTimeOfCall(20);  // after that the call is repeated

// A call that reaches a server just as it stops is CANCELLED by gRPC, without a reason.
inline bool WasNotAnswered(const absl::Status& status) {
  const bool dropped = absl::IsCancelled(status) && client::ErrorReason(status).empty();
  return absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status) || dropped;
}

template <typename Request, typename Response>
absl::StatusOr<Response> Ask(Stub& stub,
                             grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                                          Response*),
                             const Request& request) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kTimeOfCall);
  context.set_wait_for_ready(true);
  Response response;
  const absl::Status status = client::FromGrpc((stub.*method)(&context, request, &response));
  if (!status.ok()) return status;
  return response;
}

}  // namespace ballpiston::torture
