// ballpiston pin: pins jobs, so that their results do not expire, or unpins them. Prints each job's
// name and whether it is pinned.
#include "client/command/connection.h"
#include "client/command/hint.h"

namespace ballpiston::client {

VerbResult Pin(const Options& options, Terminal& terminal) {
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    absl::Status first_error;
    for (const std::string& name : options.jobs) {
      const auto job = connection.Ask([&] { return connection.client.Pin(name, !options.undo); });
      first_error.Update(HintIfExpired(job.status(), connection, name));
      if (!job.ok()) continue;
      terminal.out << job->name() << (job->pinned() ? " pinned" : " unpinned") << std::endl;
    }
    if (!first_error.ok()) return first_error;
    return ExitCode::kDone;
  });
}

}  // namespace ballpiston::client
