// Get, Cancel, Delete and Watch: a job's name, and the id of a cancellation.
#include "ballpiston/v1/ensemble.pb.h"
#include "server/book/job_name.h"
#include "server/convert/errors.h"
#include "server/rpc/request_check.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

void CheckJobRequest(const std::string& bytes) {
  v1::CancelEnsembleJobRequest request;
  if (!request.ParseFromString(bytes)) return;
  server::RequestCheck check;
  const std::string id = check.JobId("name", request.name());
  const std::string request_id = check.RequestId(request.request_id());
  if (!check.ok()) {
    RequireNamed(check.violations(), "");
    return RequireSendable(check.status(), bytes);
  }
  Require(!id.empty() && server::JobIdOf(server::JobName(id)) == id, "a job has an id");
  RequireSendable(server::JobNotFound(request.name()), bytes);
  RequireSendable(server::JobAlreadyEnded(request.name(), "SUCCEEDED"), bytes);
  RequireSendable(server::RequestIdReused(request_id), bytes);
}

const Registration kJobRequest({.name = "job_request",
                                .check = CheckJobRequest,
                                .message = &v1::CancelEnsembleJobRequest::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
