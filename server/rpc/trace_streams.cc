// TraceOrbit: the start and the events of one orbit. SampleCollisions: the collisions of a point's
// samples. A message is computed when the reader has taken the previous one. The request bounds the
// cost of a trace (convert/trace.h).
#include <algorithm>

#include "absl/cleanup/cleanup.h"
#include "server/convert/collision_messages.h"
#include "server/convert/trace.h"
#include "server/rpc/methods.h"

namespace ballpiston::server {
namespace {

// Sends all messages for the request. `mib`: upper bound of the memory that they take.
template <typename Messages, typename Request, typename Response>
absl::Status SendAll(ServiceContext& service, Stream& stream, const Request& request, int64_t mib,
                     grpc::ServerWriter<Response>& writer) {
  const auto memory = service.quotas.calls.Take(stream.caller().name, mib);
  if (!memory.ok()) return memory.status();
  absl::StatusOr<Messages> messages = Messages::Create(request);
  if (!messages.ok()) return messages.status();
  Response message;
  const auto fill_next = [&] {
    service.quotas.traces.Await(std::max(service.threads.workers() / 4, 1));
    const absl::Cleanup end = [&] { service.quotas.traces.End(); };
    return messages->FillNext(message);
  };
  while (fill_next()) {
    if (const absl::Status proceed = stream.Proceed(); !proceed.ok()) return proceed;
    const bool is_empty = message.ByteSizeLong() == 0;
    if (!is_empty && !writer.Write(message)) return absl::CancelledError("the client is gone");
    message.Clear();
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status TraceOrbit(ServiceContext& service, Stream& stream,
                        const v1::TraceOrbitRequest& request,
                        grpc::ServerWriter<v1::TraceOrbitResponse>& writer) {
  return SendAll<TraceMessages>(service, stream, request, kMibOfCall, writer);
}

absl::Status SampleCollisions(ServiceContext& service, Stream& stream,
                              const v1::SampleCollisionsRequest& request,
                              grpc::ServerWriter<v1::SampleCollisionsResponse>& writer) {
  return SendAll<CollisionMessages>(service, stream, request, kMibOfSampler, writer);
}

}  // namespace ballpiston::server
