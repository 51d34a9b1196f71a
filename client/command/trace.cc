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
    bool has_begun = false;
    const auto print = [&](const v1::TraceOrbitResponse& message) {
      has_begun = true;
      return Print(message, terminal.out);
    };
    const auto trace = [&] { return connection.client.Trace(options.trace, print); };
    absl::Status status = trace();
    // The private server may have been about to stop.
    if (absl::IsUnavailable(status) && !has_begun && connection.local) {
      status = connection.Revive();
      if (status.ok()) status = trace();
    }
    if (!status.ok()) return status;
    return ExitCode::kDone;
  });
}

}  // namespace ballpiston::client
