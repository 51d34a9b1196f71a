#include <limits>
#include <utility>

#include "server/rpc/methods.h"
#include "server/rpc/request_check.h"

namespace ballpiston::server {

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

}  // namespace ballpiston::server
