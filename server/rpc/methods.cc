// The methods of jobs and their results that read or change the book, and EvaluatePairs. The others
// have files of their own.
#include "server/rpc/methods.h"

#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/convert/analytic.h"
#include "server/convert/spec.h"
#include "server/rpc/request_check.h"
#include "server/store/job_name.h"

namespace ballpiston::server {
namespace {

absl::Status Check(const CheckedSpec& spec, const RequestCheck& check) {
  if (spec.violations.empty()) return check.status();
  std::vector<FieldViolation> all = spec.violations;
  all.insert(all.end(), check.violations().begin(), check.violations().end());
  return InvalidSpec(all);
}

void LogAcceptance(const Call& call, const v1::EnsembleJob& job) {
  LogDone(call, job.answered_from_store() ? "question answered by a job" : "job accepted",
          job.name(), absl::StrCat(job.progress().points()));
}

}  // namespace

// ---- jobs ----

absl::StatusOr<v1::EnsembleJob> CreateEnsembleJob(ServiceContext& service, const Call& call,
                                                  const v1::CreateEnsembleJobRequest& request) {
  if (service.draining) return ShuttingDown();
  RequestCheck check;
  check.UnknownFields(request);
  v1::CreateEnsembleJobRequest accepted = request;
  accepted.set_request_id(check.RequestId(request.request_id()));
  check.Priority("priority", request.priority());
  check.LabelsIn("labels", request.labels());
  Normalize(*accepted.mutable_spec());
  CheckedSpec spec = CheckSpec(accepted.spec());
  const bool is_valid = spec.violations.empty();
  if (is_valid) AddViolations(service.ladder.ViolationsHere(spec.spec), spec);
  if (!is_valid || !check.ok()) return Check(spec, check);
  absl::StatusOr<v1::EnsembleJob> job = service.book.Create(call.caller, accepted, spec);
  if (job.ok()) LogAcceptance(call, *job);
  return job;
}

absl::StatusOr<v1::EnsembleJob> GetEnsembleJob(ServiceContext& service, const Call& call,
                                               const v1::GetEnsembleJobRequest& request) {
  RequestCheck check;
  const std::string id = check.JobId("name", request.name());
  if (!check.ok()) return check.status();
  return service.book.Get(call.caller, id);
}

absl::StatusOr<v1::ListEnsembleJobsResponse> ListEnsembleJobs(
    ServiceContext& service, const Call& call, const v1::ListEnsembleJobsRequest& request) {
  RequestCheck check;
  JobsQuery query;
  query.max_jobs = check.PageSize(request.page_size());
  query.before = check.PageStart(request, std::numeric_limits<int64_t>::max());
  query.max_bytes = kMaxPageBytes;
  const bool is_basic = request.view() == v1::ListEnsembleJobsRequest::BASIC;
  query.grid = is_basic ? Grid::kLeftOut : Grid::kIncluded;
  check.View(request);
  query.filter = check.Filter(request);
  if (!check.ok()) return check.status();
  absl::StatusOr<JobsPage> page = service.book.List(call.caller, query);
  if (!page.ok()) return page.status();
  v1::ListEnsembleJobsResponse response;
  for (v1::EnsembleJob& job : page->jobs) *response.add_jobs() = std::move(job);
  if (page->next_before) response.set_next_page_token(NextPageToken(request, *page->next_before));
  return response;
}

absl::StatusOr<v1::EnsembleJob> CancelEnsembleJob(ServiceContext& service, const Call& call,
                                                  const v1::CancelEnsembleJobRequest& request) {
  RequestCheck check;
  const std::string id = check.JobId("name", request.name());
  const std::string request_id = check.RequestId(request.request_id());
  if (!check.ok()) return check.status();
  absl::StatusOr<v1::EnsembleJob> job = service.book.Cancel(call.caller, id, request_id);
  if (job.ok()) LogDone(call, "job cancelled on request", job->name());
  return job;
}

absl::StatusOr<v1::EnsembleJob> UpdateEnsembleJob(ServiceContext& service, const Call& call,
                                                  const v1::UpdateEnsembleJobRequest& request) {
  RequestCheck check;
  const std::string id = check.JobId("job.name", request.job().name());
  const JobChange change = check.Change(request);
  if (!check.ok()) return check.status();
  return service.book.Update(call.caller, id, change);
}

absl::StatusOr<google::protobuf::Empty> DeleteEnsembleJob(
    ServiceContext& service, const Call& call, const v1::DeleteEnsembleJobRequest& request) {
  RequestCheck check;
  const std::string id = check.JobId("name", request.name());
  if (!check.ok()) return check.status();
  const absl::Status deleted = service.book.Delete(call.caller, id);
  if (!deleted.ok()) return deleted;
  LogDone(call, "job deleted", request.name());
  return google::protobuf::Empty();
}

// ---- results ----

absl::StatusOr<v1::ListResultsResponse> ListResults(ServiceContext& service, const Call& call,
                                                    const v1::ListResultsRequest& request) {
  RequestCheck check;
  const std::string id = check.JobId("parent", request.parent());
  ResultsQuery query;
  query.max_points = check.PageSize(request.page_size());
  query.first_point = check.PageStart(request, 0);
  query.max_bytes = kMaxPageBytes;
  query.histograms = request.view() != v1::ListResultsRequest::BASIC;
  check.View(request);
  if (!check.ok()) return check.status();
  absl::StatusOr<ResultsPage> page = service.book.Results(call.caller, id, query);
  if (!page.ok()) return page.status();
  v1::ListResultsResponse response;
  for (v1::PointResult& result : page->points) *response.add_results() = std::move(result);
  if (page->next_point) response.set_next_page_token(NextPageToken(request, *page->next_point));
  return response;
}

absl::StatusOr<v1::PointResult> GetResult(ServiceContext& service, const Call& call,
                                          const v1::GetResultRequest& request) {
  const std::optional<ResultId> id = ResultIdOf(request.name());
  if (!id) {
    return InvalidRequest(
        {{"name", "is not the name of a result: ensembleJobs/{id}/results/{index}"}});
  }
  if (request.unfinished()) {
    auto now = service.book.UnfinishedResult(call.caller, id->job, id->point);
    if (!now.ok()) return now.status();
    if (*now) return **std::move(now);
  }
  return service.book.Result(call.caller, id->job, id->point);
}

// ---- closed forms ----

absl::StatusOr<v1::EvaluatePairsResponse> EvaluatePairs(ServiceContext&, const Call&,
                                                        const v1::EvaluatePairsRequest& request) {
  return EvaluatePairs(request);
}

}  // namespace ballpiston::server
