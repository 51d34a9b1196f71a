// ballpiston watch: shows a job's progress until it ends.
#include "client/command/connection.h"
#include "client/command/follow_job.h"

namespace ballpiston::client {

VerbResult Watch(const Options& options, Terminal& terminal) {
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const auto end = FollowJob(connection, options.jobs.front(), StyleOf(options), terminal);
    if (!end.ok()) return end.status();
    return ReportEnd(*end, terminal);
  });
}

}  // namespace ballpiston::client
