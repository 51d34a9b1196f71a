// ListResults and ListEnsembleJobs: names, sizes and tokens of pages.
#include <cstdint>
#include <limits>

#include "absl/strings/str_cat.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "server/api/request_check.h"
#include "server/jobs/job_name.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

using server::RequestCheck;

void CheckPage(const v1::ListResultsRequest& request, const std::string& bytes,
               const std::string& list, int64_t first) {
  RequestCheck check;
  const int size = check.PageSize(request.page_size());
  const int64_t start = check.PageStart(request.page_token(), list, first);
  if (!check.ok()) return RequireSendable(check.status(), bytes);
  Require(size >= 1 && size <= 1000, "a page has a size");
  Require(start >= 0, "a page has a start");
  Require(RequestCheck().PageStart(RequestCheck::PageToken(list, start), list, first) == start,
          "a token leads back");
  RequestCheck other;
  other.PageStart(request.page_token(), "another", 0);
  Require(other.ok() == request.page_token().empty(), "a token is good for its list alone");
}

void CheckListRequest(const std::string& bytes) {
  v1::ListResultsRequest request;
  if (!request.ParseFromString(bytes)) return;
  if (request.parent().empty()) {  // the other list: it has none
    return CheckPage(request, bytes, "jobs", std::numeric_limits<int64_t>::max());
  }
  RequestCheck check;
  const std::string id = check.JobId("parent", request.parent());
  if (!check.ok()) return RequireSendable(check.status(), bytes);
  Require(server::JobName(id) == request.parent(), "a name is its job's");
  CheckPage(request, bytes, absl::StrCat("results:", id), 0);
}

const Registration kListRequest({.name = "list_request",
                                 .check = CheckListRequest,
                                 .message = &v1::ListResultsRequest::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
