// ListEnsembleJobs: sizes and tokens of pages, filters.
#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "server/rpc/request_check.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

void CheckListJobsRequest(const std::string& bytes) {
  v1::ListEnsembleJobsRequest request;
  if (!request.ParseFromString(bytes)) return;
  RequirePage(request, bytes);
  server::RequestCheck check;
  const server::JobFilter filter = check.Filter(request);
  if (!check.ok()) {
    RequireNamed(check.violations(), "");
    return RequireSendable(check.status(), bytes);
  }
  for (const int state : request.states()) {
    Require(v1::EnsembleJob::State_IsValid(state) && state != 0, "an accepted state has a name");
    Require(filter.MatchesState(static_cast<server::JobState>(state)), "a listed state matches");
  }
  for (const int experiment : request.experiments()) {
    Require(v1::EnsembleSpec::Experiment_IsValid(experiment) && experiment != 0,
            "an accepted experiment has a name");
  }
  Require(!request.has_since() || absl::ToUnixSeconds(filter.since) == request.since().seconds(),
          "a time keeps its second");
}

const Registration kListJobsRequest({.name = "list_jobs_request",
                                     .check = CheckListJobsRequest,
                                     .message = &v1::ListEnsembleJobsRequest::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
