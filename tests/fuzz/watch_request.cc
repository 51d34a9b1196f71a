// WatchEnsembleJob: a job's name, and a resume token.
#include "ballpiston/v1/ensemble.pb.h"
#include "server/api/request_check.h"
#include "server/api/resume_token.h"
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
  const auto token = server::ParseResumeToken(request.resume_token());
  if (!token) return;
  Require(token->finished >= 0, "a number of points");
  Require(server::ParseResumeToken(server::ResumeTokenText(*token)) == token, "a token stays");
}

std::vector<std::string> Tokens() {
  v1::WatchEnsembleJobRequest request;
  request.set_name("ensembleJobs/0123456789abcdef");
  request.set_resume_token(server::ResumeTokenText({.job = "0123456789abcdef",
                                                    .restarts = 1,
                                                    .finished = 12,
                                                    .instance = "fedcba9876543210",
                                                    .change = 345}));
  return {request.SerializeAsString()};
}

const Registration kWatchRequest({.name = "watch_request",
                                  .check = CheckWatchRequest,
                                  .message = &v1::WatchEnsembleJobRequest::default_instance(),
                                  .made_seeds = Tokens});

}  // namespace
}  // namespace ballpiston::fuzz
