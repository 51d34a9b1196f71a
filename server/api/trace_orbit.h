// TraceOrbit: the start and the events of one orbit, in the frame of stream_reactor.h.
//
// The events of a message are computed when gRPC has sent the previous message, so a trace runs as
// fast as its reader, and principals take turns at the threads after each message. The request
// bounds the cost of a trace (convert/trace.h). Its memory counts among the bytes of the
// principal's calls, because a stalled reader keeps that memory in use.
#pragma once

#include <cstdint>
#include <optional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ballpiston/v1/trace.pb.h"
#include "server/api/call.h"
#include "server/api/service_context.h"
#include "server/api/stream_reactor.h"
#include "server/convert/trace.h"

namespace ballpiston::server {

class TraceReactor : public StreamReactor<v1::TraceOrbitResponse> {
 public:
  static TraceReactor* Start(ServiceContext& service, grpc::CallbackServerContext& context,
                             const absl::StatusOr<Call>& call,
                             const v1::TraceOrbitRequest& request);

  // Only checks the credentials: the end of each write schedules the next message.
  void Look(Clock::time_point now) override;

 private:
  TraceReactor(ServiceContext& service, grpc::CallbackServerContext& context,
               const v1::TraceOrbitRequest& request)
      : StreamReactor(service, context), request_(request) {}

  absl::Status Tell() override;
  absl::Status Begin();
  void ReleaseCall() override;

  const v1::TraceOrbitRequest request_;

  std::optional<TraceMessages> messages_;  // of Advance
  int64_t bytes_held_ = 0;                 // in held_calls
};

}  // namespace ballpiston::server
