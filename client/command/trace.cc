// ballpiston trace: prints the events of one orbit as JSON lines.
#include "client/command/connection.h"
#include "client/output/json.h"

namespace ballpiston::client {
namespace {

// False if the output cannot be written, e.g. because its reader has closed the pipe.
bool Print(const v1::TraceOrbitResponse& message, std::ostream& out) {
  if (message.has_start()) out << Json(message.start()) << '\n';
  PrintJsonLines(message.events(), out);
  out.flush();
  return out.good();
}

}  // namespace

VerbResult Trace(const Options& options, Terminal& terminal) {
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const absl::Status status = connection.client.Trace(
        options.trace, [&](const auto& message) { return Print(message, terminal.out); });
    if (!status.ok()) return status;
    return ExitCode::kDone;
  });
}

}  // namespace ballpiston::client
