#include <utility>

#include "server/rpc/methods.h"
#include "server/rpc/request_check.h"
#include "server/rpc/result_name.h"

namespace ballpiston::server {

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
  for (v1::PointResult& result : page->points)
    *response.add_results() = Named(std::move(result), id);
  if (page->next_point) response.set_next_page_token(NextPageToken(request, *page->next_point));
  return response;
}

}  // namespace ballpiston::server
