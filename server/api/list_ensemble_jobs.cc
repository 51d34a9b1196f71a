#include <limits>
#include <vector>

#include "server/api/methods.h"
#include "server/api/request_check.h"

namespace ballpiston::server {
namespace {

constexpr char kList[] = "jobs";

}  // namespace

absl::StatusOr<v1::ListEnsembleJobsResponse> ListEnsembleJobs(
    ServiceContext& service, const Call& call, const v1::ListEnsembleJobsRequest& request) {
  RequestCheck check;
  const int size = check.PageSize(request.page_size());
  const int64_t before =
      check.PageStart(request.page_token(), kList, std::numeric_limits<int64_t>::max());
  if (!check.ok()) return check.status();
  // One more than fits: whether there is another page.
  absl::StatusOr<std::vector<ListedJob>> jobs = service.book.List(call.caller, before, size + 1);
  if (!jobs.ok()) return jobs.status();
  v1::ListEnsembleJobsResponse response;
  size_t bytes = 0;
  int64_t last = 0;
  for (ListedJob& listed : *jobs) {
    bytes += listed.job.ByteSizeLong();
    if (response.jobs_size() == size || (response.jobs_size() > 0 && bytes > kMaxPageBytes)) {
      response.set_next_page_token(RequestCheck::PageToken(kList, last));
      break;
    }
    last = listed.sequence;
    *response.add_jobs() = std::move(listed.job);
  }
  return response;
}

}  // namespace ballpiston::server
