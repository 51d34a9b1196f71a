// ballpiston analytic, plan, list, server address and server status: each makes one call of the
// server and prints the answer.
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/command/connection.h"
#include "client/command/question.h"
#include "client/output/analytic_output.h"
#include "client/output/job_list.h"
#include "client/output/plan_output.h"
#include "client/output/status_output.h"

namespace ballpiston::client {

VerbResult Analytic(const Options& options, Terminal& terminal) {
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const auto response = connection.client.EvaluatePairs(options.closed_forms);
    if (!response.ok()) return response.status();
    const auto& outgoing = options.closed_forms.outgoing_epsilon();
    PrintAnalytics(*response, {outgoing.begin(), outgoing.end()}, options.format, terminal.out);
    return ExitCode::kDone;
  });
}

VerbResult Plan(const Options& options, Terminal& terminal) {
  return WithQuestion(
      options, terminal,
      [&](const Connection& connection, const v1::EnsembleSpec& spec) -> VerbResult {
        const auto plan = connection.client.Plan(spec);
        if (!plan.ok()) return plan.status();
        PrintPlan(spec, *plan, options.format, terminal.out);
        return ExitCode::kDone;
      });
}

VerbResult ListJobs(const Options& options, Terminal& terminal) {
  if (options.limit < 1) {
    return absl::InvalidArgumentError(absl::StrCat("--limit: ", options.limit, " is less than 1"));
  }
  v1::ListEnsembleJobsRequest request = options.which_jobs;
  request.mutable_labels()->insert(options.labels.begin(), options.labels.end());
  request.set_view(JobViewFor(options.format));
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const auto jobs = connection.client.List(request, options.limit);
    if (!jobs.ok()) return jobs.status();
    PrintJobs(*jobs, absl::Now(), options.format, terminal.out);
    return ExitCode::kDone;
  });
}

VerbResult ServerAddress(const Options& options, Terminal& terminal) {
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    terminal.out << connection.address << '\n';
    return ExitCode::kDone;
  });
}

VerbResult ServerStatus(const Options& options, Terminal& terminal) {
  return WithRunningServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const auto status = connection.client.Status();
    if (!status.ok()) return status.status();
    PrintStatus(*status, absl::Now(), options.format, terminal.out);
    return ExitCode::kDone;
  });
}

}  // namespace ballpiston::client
