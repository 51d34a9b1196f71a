// ballpiston list: prints the server's jobs, the newest first.
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/command/connection.h"
#include "client/output/job_list.h"

namespace ballpiston::client {

VerbResult ListJobs(const Options& options, Terminal& terminal) {
  if (options.limit < 1) {
    return absl::InvalidArgumentError(absl::StrCat("--limit: ", options.limit, " is less than 1"));
  }
  v1::ListEnsembleJobsRequest request = options.which_jobs;
  request.mutable_labels()->insert(options.labels.begin(), options.labels.end());
  request.set_view(JobViewFor(options.format));
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const auto jobs =
        connection.Ask([&] { return connection.client.List(request, options.limit); });
    if (!jobs.ok()) return jobs.status();
    PrintJobs(*jobs, absl::Now(), options.format, terminal.out);
    return ExitCode::kDone;
  });
}

}  // namespace ballpiston::client
