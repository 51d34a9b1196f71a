// ballpiston analytic, plan, list, trace, server address and server status: each makes one call of
// the server and prints the answer.
#include "absl/time/clock.h"
#include "client/command/connection.h"
#include "client/command/question.h"
#include "client/output/answers.h"
#include "client/output/json.h"

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
  return WithQuestion(options, terminal,
                      [&](const Connection& connection, const Options& asked) -> VerbResult {
                        const auto plan = connection.client.Plan(asked.spec);
                        if (!plan.ok()) return plan.status();
                        PrintPlan(asked.spec, *plan, options.format, terminal.out);
                        return ExitCode::kDone;
                      });
}

VerbResult ListJobs(const Options& options, Terminal& terminal) {
  v1::ListEnsembleJobsRequest request = options.which_jobs;
  request.mutable_labels()->insert(options.labels.begin(), options.labels.end());
  using Request = v1::ListEnsembleJobsRequest;
  request.set_view(IsJson(options.format) ? Request::FULL : Request::BASIC);
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const auto jobs = connection.client.List(request, options.limit);
    if (!jobs.ok()) return jobs.status();
    PrintJobs(*jobs, absl::Now(), options.format, terminal.out);
    return ExitCode::kDone;
  });
}

// The events of an orbit as JSON lines, as they come. Ends if the output cannot be written, e.g.
// because its reader has closed the pipe.
VerbResult Trace(const Options& options, Terminal& terminal) {
  const auto print = [&out = terminal.out](const v1::TraceOrbitResponse& message) {
    if (message.has_start()) out << Json(message.start()) << '\n';
    PrintJsonLines(message.events(), out);
    out.flush();
    return out.good();
  };
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const absl::Status status = connection.client.Trace(options.trace, print);
    if (!status.ok()) return status;
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
  const auto print = [&](const Connection& connection) -> VerbResult {
    const auto status = connection.client.Status();
    if (!status.ok()) return status.status();
    PrintStatus(*status, absl::Now(), options.format, terminal.out);
    return ExitCode::kDone;
  };
  return WithServer(options, terminal, print, /*may_start=*/false);
}

}  // namespace ballpiston::client
