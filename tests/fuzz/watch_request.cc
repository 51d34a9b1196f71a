// WatchEnsembleJob: a job's name, and a resume token.
#include "ballpiston/storage/tokens.pb.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "server/rpc/request_check.h"
#include "server/rpc/tokens.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

void CheckWatchRequest(const std::string& bytes) {
  v1::WatchEnsembleJobRequest request;
  if (!request.ParseFromString(bytes)) return;
  server::RequestCheck check;
  check.JobId("name", request.name());
  if (!check.ok()) RequireSendable(check.status(), bytes);
  const auto token = server::ParseToken<storage::ResumeToken>(request.resume_token());
  if (!token) return;
  const std::string text = server::TokenText(*token);
  const auto again = server::ParseToken<storage::ResumeToken>(text);
  Require(again && server::TokenText(*again) == text, "a token stays");
}

std::vector<std::string> Tokens() {
  v1::WatchEnsembleJobRequest request;
  request.set_name("ensembleJobs/0123456789abcdef");
  storage::ResumeToken token;
  token.set_job("0123456789abcdef");
  token.set_restarts(1);
  token.set_finished(12);
  token.set_instance("fedcba9876543210");
  token.set_change(345);
  request.set_resume_token(server::TokenText(token));
  return {request.SerializeAsString()};
}

const Registration kWatchRequest({.name = "watch_request",
                                  .check = CheckWatchRequest,
                                  .message = &v1::WatchEnsembleJobRequest::default_instance(),
                                  .made_seeds = Tokens});

}  // namespace
}  // namespace ballpiston::fuzz
