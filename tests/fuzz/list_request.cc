// ListResults: names, sizes and tokens of pages.
#include "ballpiston/v1/ensemble.pb.h"
#include "server/book/job_name.h"
#include "server/rpc/request_check.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

void CheckListRequest(const std::string& bytes) {
  v1::ListResultsRequest request;
  if (!request.ParseFromString(bytes)) return;
  server::RequestCheck check;
  const std::string id = check.JobId("parent", request.parent());
  if (!check.ok()) return RequireSendable(check.status(), bytes);
  Require(server::JobName(id) == request.parent(), "a name is its job's");
  RequirePage(request, bytes);
}

const Registration kListRequest({.name = "list_request",
                                 .check = CheckListRequest,
                                 .message = &v1::ListResultsRequest::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
