// CreateEnsembleJob: all checks before a job is made.
#include "absl/strings/ascii.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "server/book/acceptance.h"
#include "server/rpc/request_check.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

void CheckRequestId(const std::string& request_id) {
  server::RequestCheck check;
  const std::string id = check.RequestId(request_id);
  if (!check.ok()) return RequireSendable(check.status(), request_id);
  Require(id.empty() == request_id.empty(), "only nothing is nothing");
  Require(id == absl::AsciiStrToLower(request_id), "equal ids are equal");
  Require(server::RequestCheck().RequestId(id) == id, "an id is its own");
}

void CheckCreateRequest(const std::string& bytes) {
  v1::CreateEnsembleJobRequest request;
  if (!request.ParseFromString(bytes)) return;
  CheckRequestId(request.request_id());
  if (!RequireJudged(request.spec(), bytes)) return;
  Require(!server::PayloadOf(request).empty(), "a request has a hash");
  Require(server::QuestionOf(request.spec(), "1").empty() == request.spec().target().has_budget(),
          "a question has a hash, unless it depends on the machine");
}

const Registration kCreateRequest({.name = "create_request",
                                   .check = CheckCreateRequest,
                                   .message = &v1::CreateEnsembleJobRequest::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
