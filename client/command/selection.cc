#include "client/command/selection.h"

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

absl::Status CheckSelection(const Options& options) {
  if (options.jobs.empty() && options.labels.empty()) {
    return absl::InvalidArgumentError("name a JOB, or give --label KEY=VALUE");
  }
  if (options.jobs.empty() || !options.given.contains("--label")) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "--label and names of jobs exclude each other: give one of them");
}

absl::Status NoneFound(const JobStates& states) {
  const auto spelled = [](std::string* out, v1::EnsembleJob::State state) {
    absl::StrAppend(out, Spelling(state));
  };
  return absl::NotFoundError(absl::StrCat("no job has these labels",
                                          states.empty() ? "" : " and one of the states ",
                                          absl::StrJoin(states, ", ", spelled)));
}

absl::StatusOr<std::vector<v1::EnsembleJob>> SelectedJobs(const Connection& connection,
                                                          const Options& options,
                                                          const JobStates& states) {
  std::vector<v1::EnsembleJob> named;
  for (const std::string& name : options.jobs) named.emplace_back().set_name(name);
  if (!named.empty()) return named;
  v1::ListEnsembleJobsRequest request;
  request.set_view(v1::ListEnsembleJobsRequest::BASIC);
  request.mutable_labels()->insert(options.labels.begin(), options.labels.end());
  for (const auto state : states) request.add_states(state);
  auto jobs = connection.client.List(request);
  if (jobs.ok() && jobs->empty()) return NoneFound(states);
  return jobs;
}

}  // namespace

VerbResult WithJobs(const Options& options, const Terminal& terminal, const JobStates& states,
                    const VerbOfJobs& verb) {
  if (absl::Status bad = CheckSelection(options); !bad.ok()) return bad;
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const auto jobs = SelectedJobs(connection, options, states);
    if (!jobs.ok()) return jobs.status();
    return verb(connection, *jobs);
  });
}

}  // namespace ballpiston::client
