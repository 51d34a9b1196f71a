// SampleCollisions: the collisions of a point's samples. The collisions of a message are computed
// when the reader has taken the previous message.
#include "server/convert/collision_messages.h"
#include "server/rpc/methods.h"

namespace ballpiston::server {
namespace {

// Takes a turn for each message, so other calls can compute between two messages.
bool FillInTurn(ServiceContext& service, const Stream& stream, CollisionMessages& messages,
                v1::SampleCollisionsResponse& message) {
  const Quota::Part turn = service.quotas.turns.Await(stream.caller().name);
  return messages.FillNext(message);
}

}  // namespace

absl::Status SampleCollisions(ServiceContext& service, Stream& stream,
                              const v1::SampleCollisionsRequest& request,
                              grpc::ServerWriter<v1::SampleCollisionsResponse>& writer) {
  const auto memory = service.quotas.call_bytes.Take(stream.caller().name, kBytesOfSampler);
  if (!memory.ok()) return memory.status();
  absl::StatusOr<CollisionMessages> messages = CollisionMessages::Create(request);
  if (!messages.ok()) return messages.status();
  v1::SampleCollisionsResponse message;
  while (true) {
    if (const absl::Status proceed = stream.Proceed(); !proceed.ok()) return proceed;
    message.Clear();
    if (!FillInTurn(service, stream, *messages, message)) return absl::OkStatus();
    if (message.sample().empty()) continue;
    if (!writer.Write(message)) return absl::CancelledError("the client is gone");
  }
}

}  // namespace ballpiston::server
