// The requests of all calls; of GetServerStatus there is nothing to read. tests/questions checks
// that accepted questions can be planned.
#include "absl/strings/ascii.h"
#include "ballpiston/storage/tokens.pb.h"
#include "ballpiston/v1/analytic.pb.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/trace.pb.h"
#include "server/book/acceptance.h"
#include "server/convert/analytic.h"
#include "server/convert/errors.h"
#include "server/convert/spec.h"
#include "server/convert/trace.h"
#include "server/rpc/request_check.h"
#include "server/store/job_name.h"
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

// CreateEnsembleJob: all checks before a job is made.
void CheckCreateRequest(const v1::CreateEnsembleJobRequest& request, const std::string& bytes) {
  CheckRequestId(request.request_id());
  if (!RequireJudged(request.spec(), bytes)) return;
  Require(!server::PayloadOf(request).empty(), "a request has a hash");
  Require(server::QuestionOf(request.spec(), "1").empty() == request.spec().target().has_budget(),
          "a question has a hash, unless it depends on the machine");
}

// ListResults: names, sizes and tokens of pages.
void CheckListRequest(const v1::ListResultsRequest& request, const std::string& bytes) {
  server::RequestCheck check;
  const std::string id = check.JobId("parent", request.parent());
  if (!check.ok()) return RequireSendable(check.status(), bytes);
  Require(server::JobName(id) == request.parent(), "a name is its job's");
  RequirePage(request, bytes);
}

// ListEnsembleJobs: sizes and tokens of pages, filters.
void CheckListJobsRequest(const v1::ListEnsembleJobsRequest& request, const std::string& bytes) {
  RequirePage(request, bytes);
  server::RequestCheck check;
  const server::JobFilter filter = check.Filter(request);
  if (!check.ok()) {
    RequireNamed(check.violations());
    return RequireSendable(check.status(), bytes);
  }
  for (const int state : request.states()) {
    Require(v1::EnsembleJob::State_IsValid(state) && state != 0, "an accepted state has a name");
    Require(filter.MatchesState(static_cast<server::JobState>(state)), "a listed state matches");
  }
  for (const int experiment : request.experiments()) {
    Require(v1::EnsembleSpec::Experiment_IsValid(experiment) && experiment != 0,
            "an accepted experiment has a name");
  }
  Require(!request.has_since() || absl::ToUnixSeconds(filter.since) == request.since().seconds(),
          "a time keeps its second");
}

// Get, Cancel, Delete and Watch: a job's name, and the id of a cancellation.
void CheckJobRequest(const v1::CancelEnsembleJobRequest& request, const std::string& bytes) {
  server::RequestCheck check;
  const std::string id = check.JobId("name", request.name());
  const std::string request_id = check.RequestId(request.request_id());
  if (!check.ok()) {
    RequireNamed(check.violations());
    return RequireSendable(check.status(), bytes);
  }
  Require(!id.empty() && server::JobIdOf(server::JobName(id)) == id, "a job has an id");
  RequireSendable(server::JobNotFound(request.name()), bytes);
  RequireSendable(server::JobAlreadyEnded(request.name(), "SUCCEEDED"), bytes);
  RequireSendable(server::RequestIdReused(request_id), bytes);
}

// WatchEnsembleJob: a job's name, and a resume token.
void CheckWatchRequest(const v1::WatchEnsembleJobRequest& request, const std::string& bytes) {
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

// Larger requests are skipped, because every answer is evaluated and a few pairs can show every
// error.
constexpr int kMostPairs = 16;

void RequireFinite(const v1::PairAnalytics& point) {
  Require(std::isfinite(point.tau_ball_piston()) && point.tau_ball_piston() > 0, "a mean time");
  Require(std::isfinite(point.tau_ball_wall()) && point.tau_ball_wall() > 0, "a mean time");
  Require(std::isfinite(point.volume()) && point.volume() > 0, "a volume");
  for (const v1::EnergyAnalytics& energy : point.energies()) {
    Require(std::isfinite(energy.f()) && energy.f() >= 0, "a rate");
    for (const double kernel : energy.kernel()) Require(kernel >= 0, "a kernel");
  }
  for (const v1::CanonicalAnalytics& canonical : point.canonical()) {
    Require(std::isnormal(canonical.mean_h()) && canonical.mean_h() > 0, "an average");
    Require(std::isnormal(canonical.exchange_rate()), "an exchange rate");
    Require(std::isfinite(canonical.rare_limit_exchange_rate()), "its limit");
  }
}

// EvaluatePairs: checks the whole answer.
void CheckPairsRequest(const v1::EvaluatePairsRequest& request, const std::string& bytes) {
  if (request.rho_size() * request.delta_size() > kMostPairs) return;
  const auto response = server::EvaluatePairs(request);
  if (!response.ok()) return RequireSendable(response.status(), bytes);
  Require(response->points_size() == request.rho_size() * request.delta_size(), "every pair");
  for (const v1::PairAnalytics& point : response->points()) {
    Require(point.energies_size() == request.epsilon_size(), "every energy");
    Require(point.canonical_size() == request.beta_size() + request.temperature_size(),
            "every temperature");
    RequireFinite(point);
  }
}

void RequireNumbers(const v1::TraceOrbitResponse& message) {
  const std::string text = message.ShortDebugString();
  for (const char* other : {": nan", ": -nan", ": inf", ": -inf", "energy: -"}) {
    Require(!absl::StrContains(text, other), "every number is finite, no energy negative");
  }
}

// TraceOrbit: the start and the first events of every request that is accepted.
void CheckTraceRequest(const v1::TraceOrbitRequest& request, const std::string& bytes) {
  auto messages = server::TraceMessages::Create(request);
  if (!messages.ok()) return RequireSendable(messages.status(), bytes);
  v1::TraceOrbitResponse message;
  messages->FillNext(message);
  RequireNumbers(message);
  const v1::TraceStart& start = message.start();
  Require(start.eta() >= 0 && start.tip() > 0, "a geometry");
  Require(start.balls_size() >= 1 && start.pistons_size() >= 1, "bodies");
  message.Clear();
  Require(messages->FillNext(message), "events follow");
  RequireNumbers(message);
  double time = 0;
  for (const v1::TraceEvent& event : message.events()) {
    Require(event.event() != v1::TraceEvent::escape, "no ball escapes");
    Require(event.time() >= time && std::isfinite(event.time()), "time goes on");
    Require(event.has_ball() || event.has_piston(), "a body takes part");
    time = event.time();
  }
}

}  // namespace

std::vector<FuzzTarget> RequestTargets() {
  return {
      OfMessage<v1::CreateEnsembleJobRequest, CheckCreateRequest>("create_request"),
      OfMessage<v1::ListResultsRequest, CheckListRequest>("list_request"),
      OfMessage<v1::ListEnsembleJobsRequest, CheckListJobsRequest>("list_jobs_request"),
      OfMessage<v1::CancelEnsembleJobRequest, CheckJobRequest>("job_request"),
      OfMessage<v1::WatchEnsembleJobRequest, CheckWatchRequest>("watch_request", Tokens),
      OfMessage<v1::EvaluatePairsRequest, CheckPairsRequest>("pairs_request"),
      OfMessage<v1::TraceOrbitRequest, CheckTraceRequest>("trace_request"),
  };
}

}  // namespace ballpiston::fuzz
