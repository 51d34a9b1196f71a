// ballpiston list: prints the server's jobs, the newest first.
#include "absl/strings/str_cat.h"
#include "client/command/connection.h"
#include "client/output/job_list.h"

namespace ballpiston::client {

VerbResult ListJobs(const Options& options, Terminal& terminal) {
  if (options.limit < 1) {
    return absl::InvalidArgumentError(absl::StrCat("--limit: ", options.limit, " is less than 1"));
  }
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const auto jobs =
        connection.Ask([&] { return connection.client.List(options.which_jobs, options.limit); });
    if (!jobs.ok()) return jobs.status();
    PrintJobs(*jobs, options.format, terminal.out);
    return ExitCode::kDone;
  });
}

}  // namespace ballpiston::client
