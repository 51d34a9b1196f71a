// TraceOrbit: the start and the events of one orbit. The events of a message are computed when the
// reader has taken the previous message. The request bounds the cost of a trace (convert/trace.h).
#include "server/convert/trace.h"
#include "server/rpc/methods.h"

namespace ballpiston::server {
namespace {

// Takes a turn for each message, so other calls can compute between two messages.
void FillInTurn(ServiceContext& service, const Stream& stream, TraceMessages& messages,
                v1::TraceOrbitResponse& message) {
  const Quota::Part turn = service.quotas.turns.Await(stream.caller().name);
  messages.FillNext(message);
}

}  // namespace

absl::Status TraceOrbit(ServiceContext& service, Stream& stream,
                        const v1::TraceOrbitRequest& request,
                        grpc::ServerWriter<v1::TraceOrbitResponse>& writer) {
  const auto memory = service.quotas.call_bytes.Take(stream.caller().name, kBytesOfTrace);
  if (!memory.ok()) return memory.status();
  absl::StatusOr<TraceMessages> messages = TraceMessages::Create(request);
  if (!messages.ok()) return messages.status();
  v1::TraceOrbitResponse message;
  while (!messages->HasEnded()) {
    if (const absl::Status proceed = stream.Proceed(); !proceed.ok()) return proceed;
    message.Clear();
    FillInTurn(service, stream, *messages, message);
    if (!writer.Write(message)) return absl::CancelledError("the client is gone");
  }
  return absl::OkStatus();
}

}  // namespace ballpiston::server
