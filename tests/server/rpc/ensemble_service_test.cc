#include <cctype>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "tests/server/error_details.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"
#include "tests/server/running_server.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using v1::EnsembleJob;

// ---- bad requests ----

// A field that is not as permitted, and what the error says about it.
struct BadRequest {
  std::string field;
  std::string message;  // a part of it
  std::function<grpc::Status(RunningServer&)> call;
};

// Create with the small first-hit job, changed.
BadRequest BadSpec(std::string field, std::string message,
                   const std::function<void(v1::EnsembleSpec&)>& change) {
  v1::EnsembleSpec spec = SmallFirstHit();
  change(spec);
  return {std::move(field), std::move(message),
          [spec](RunningServer& server) { return server.Create(CreateRequest(spec)); }};
}

BadRequest BadCreate(std::string field, std::string message,
                     const std::function<void(v1::CreateEnsembleJobRequest&)>& change) {
  v1::CreateEnsembleJobRequest request = CreateRequest(Equilibrium(1, 2));
  change(request);
  return {std::move(field), std::move(message),
          [request](RunningServer& server) { return server.Create(request); }};
}

grpc::Status ListError(RunningServer& server, const v1::ListEnsembleJobsRequest& request) {
  grpc::ClientContext context;
  v1::ListEnsembleJobsResponse response;
  return server.ensemble().ListEnsembleJobs(&context, request, &response);
}

BadRequest BadList(std::string field, std::string message,
                   const std::function<void(v1::ListEnsembleJobsRequest&)>& change) {
  v1::ListEnsembleJobsRequest request;
  change(request);
  return {std::move(field), std::move(message),
          [request](RunningServer& server) { return ListError(server, request); }};
}

BadRequest BadResults(std::string field,
                      const std::function<void(v1::ListResultsRequest&)>& change) {
  v1::ListResultsRequest request;
  request.set_parent("ensembleJobs/a");
  change(request);
  return {std::move(field), "", [request](RunningServer& server) {
            grpc::ClientContext context;
            v1::ListResultsResponse response;
            return server.ensemble().ListResults(&context, request, &response);
          }};
}

v1::UpdateEnsembleJobRequest UpdateRequest(const std::string& name,
                                           const std::vector<std::string>& paths) {
  v1::UpdateEnsembleJobRequest request;
  request.mutable_job()->set_name(name);
  for (const std::string& path : paths) request.mutable_update_mask()->add_paths(path);
  return request;
}

grpc::Status Update(RunningServer& server, const v1::UpdateEnsembleJobRequest& request,
                    EnsembleJob* job) {
  grpc::ClientContext context;
  return server.ensemble().UpdateEnsembleJob(&context, request, job);
}

BadRequest BadUpdate(std::string field, std::string message, const std::vector<std::string>& paths,
                     int priority = 0) {
  v1::UpdateEnsembleJobRequest request = UpdateRequest("ensembleJobs/a", paths);
  request.mutable_job()->set_priority(priority);
  return {std::move(field), std::move(message), [request](RunningServer& server) {
            EnsembleJob job;
            return Update(server, request, &job);
          }};
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::vector<BadRequest> BadRequests() {
  using Spec = v1::EnsembleSpec;
  using Create = v1::CreateEnsembleJobRequest;
  using List = v1::ListEnsembleJobsRequest;
  using Results = v1::ListResultsRequest;
  return {
      BadSpec("spec.experiment", "", [](Spec& s) { s.clear_experiment(); }),
      BadSpec("spec.grid.rho[0]", "0.4", [](Spec& s) { s.mutable_grid()->set_rho(0, 0.4); }),
      BadSpec("spec.grid.delta[3]", "-1", [](Spec& s) { s.mutable_grid()->add_delta(-1); }),
      BadSpec("spec.grid.epsilon[2]", "nan", [](Spec& s) { s.mutable_grid()->add_epsilon(kNan); }),
      BadSpec("spec.grid.exponent[1]", "inf",
              [](Spec& s) { s.mutable_grid()->add_exponent(kInfinite); }),
      BadSpec("spec.grid.cells", "does not use", [](Spec& s) { s.mutable_grid()->add_cells("4"); }),
      BadSpec("spec.grid.cold[0]", "does not use", [](Spec& s) { s.mutable_grid()->add_cold(0); }),
      BadSpec("spec.grid", "points",  // 10^9 of them
              [](Spec& s) {
                for (int i = 0; i < 1000; ++i) {
                  s.mutable_grid()->add_rho(0.53 + 1e-6 * i);
                  s.mutable_grid()->add_delta(0.1 + 1e-6 * i);
                  s.mutable_grid()->add_epsilon(0.1 + 1e-6 * i);
                }
              }),
      BadSpec("spec.grid.rho[1]", "left out",  // of thousands of violations
              [](Spec& s) {
                for (int i = 0; i < 10'000; ++i) s.mutable_grid()->add_rho(-1);
              }),
      BadSpec("spec.target.samples", "0", [](Spec& s) { s.mutable_target()->set_samples(0); }),
      BadSpec("spec.target.budget", "",
              [](Spec& s) { s.mutable_target()->mutable_budget()->set_seconds(5); }),
      BadSpec("spec.model", "99", [](Spec& s) { s.set_model(static_cast<Spec::Model>(99)); }),
      BadCreate("request_id", "", [](Create& r) { r.set_request_id("not a uuid"); }),
      BadCreate("priority", "-100 to 100", [](Create& r) { r.set_priority(101); }),
      BadCreate("priority", "-100 to 100", [](Create& r) { r.set_priority(-101); }),
      {"request_id", "",
       [](RunningServer& server) { return server.Cancel("ensembleJobs/a", "x"); }},
      BadList("page_size", "", [](List& r) { r.set_page_size(-1); }),
      BadList("page_token", "", [](List& r) { r.set_page_token("!!!"); }),
      BadList("page_token", "", [](List& r) { r.set_page_token("am9iczotMQ=="); }),
      BadList("page_token", "",
              [](List& r) { r.set_page_token("cmVzdWx0czphOjE="); }),  // of results
      BadList("states[1]",
              "is 0; permitted: QUEUED, RUNNING, CANCELLING, SUCCEEDED, FAILED, CANCELLED",
              [](List& r) {
                r.add_states(EnsembleJob::RUNNING);
                r.add_states(EnsembleJob::STATE_UNSPECIFIED);
              }),
      BadList("states[0]", "(and 99 more)",  // of millions
              [](List& r) {
                for (int i = 0; i < 4'000'000; ++i) r.add_states(EnsembleJob::STATE_UNSPECIFIED);
              }),
      BadList("experiments[0]", "is -1",
              [](List& r) { r.add_experiments(static_cast<Spec::Experiment>(-1)); }),
      BadList("since.seconds", "is 253402300800; permitted: -62135596800 to 253402300799",
              [](List& r) { r.mutable_since()->set_seconds(253'402'300'800); }),
      BadList("since.nanos", "", [](List& r) { r.mutable_since()->set_nanos(-1); }),
      BadResults("page_size", [](Results& r) { r.set_page_size(-5); }),
      BadResults("page_token", [](Results& r) { r.set_page_token("x"); }),
      BadResults("view", [](Results& r) { r.set_view(static_cast<Results::View>(9)); }),
      BadUpdate("job.priority", "", {"priority"}, 101),
      BadUpdate("update_mask", "permitted: pinned, priority", {}),
      BadUpdate("update_mask", "permitted: pinned, priority", {"*"}),
      BadUpdate("update_mask", "permitted: pinned, priority", {"pinned", "state"}),
      BadUpdate("update_mask", "permitted: pinned, priority", {"job.pinned"})};
}

TEST(EnsembleService, EveryBadFieldIsNamed) {
  RunningServer server;
  for (const BadRequest& bad : BadRequests()) {
    SCOPED_TRACE(bad.field);
    const grpc::Status status = bad.call(server);
    EXPECT_THAT(status, StatusIs(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr(bad.message)));
    EXPECT_THAT(ReasonOf(status), testing::AnyOf("INVALID_SPEC", "INVALID_REQUEST"));
    EXPECT_THAT(DetailsOf(status).fields, testing::Contains(bad.field));
  }
  EXPECT_EQ(server.List().jobs_size(), 0);
}

TEST(EnsembleService, AllViolationsAreListedTogether) {
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.mutable_grid()->set_rho(0, 0.4);
  spec.mutable_target()->set_samples(0);
  EXPECT_THAT(DetailsOf(RunningServer().Create(CreateRequest(spec, "not a uuid"))).fields,
              testing::UnorderedElementsAre("request_id", "spec.grid.rho[0]",
                                            "spec.target.samples"));
}

// ---- Create ----

TEST(EnsembleService, AJobRunsToItsEnd) {
  RunningServer server;
  const EnsembleJob made = server.Created(CreateRequest(Equilibrium(3, 10)));
  EXPECT_THAT(made.name(), testing::StartsWith("ensembleJobs/"));
  EXPECT_EQ(made.spec().SerializeAsString(), Equilibrium(3, 10).SerializeAsString());
  EXPECT_TRUE(made.has_create_time());
  EXPECT_FALSE(made.engine_version().empty());
  const EnsembleJob ended = server.AwaitEnd(made.name());
  EXPECT_EQ(ended.state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(ended.progress().points(), 3);
  EXPECT_EQ(ended.progress().points_done(), 3);
  EXPECT_EQ(ended.progress().samples(), 3 * 10 * kFakeSamplesPerBlock);
  EXPECT_EQ(ended.progress().fraction(), 1);
  EXPECT_TRUE(ended.has_start_time());
  EXPECT_TRUE(ended.has_end_time());
  EnsembleJob now = server.Get(made.name());
  now.mutable_spec()->clear_grid();  // a watch leaves it out
  EXPECT_EQ(now.SerializeAsString(), ended.SerializeAsString());
}

TEST(EnsembleService, ARetryInUpperCaseReturnsTheSameJob) {
  RunningServer server;
  const EnsembleJob first = server.Created(CreateRequest(Equilibrium(1, 5), kUuid));
  server.AwaitEnd(first.name());
  std::string upper = kUuid;
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  const EnsembleJob again = server.Created(CreateRequest(Equilibrium(1, 5), upper));
  EXPECT_EQ(again.name(), first.name());
  EXPECT_EQ(again.state(), EnsembleJob::SUCCEEDED);
}

// gRPC's own retries obey the metadata.
TEST(EnsembleService, ALimitThatWaitingCuresTellsHowLong) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate),
                        .limits = {.max_active_jobs = 1, .max_points_per_job = 5}});
  server.Submit(Equilibrium(1, 2));
  const auto pushback = [&](int points) {
    grpc::ClientContext context;
    EnsembleJob job;
    const v1::CreateEnsembleJobRequest request = CreateRequest(Equilibrium(points, 2, 7));
    EXPECT_THAT(server.ensemble().CreateEnsembleJob(&context, request, &job),
                StatusIs(grpc::StatusCode::RESOURCE_EXHAUSTED));
    const auto& trailing = context.GetServerTrailingMetadata();
    const auto found = trailing.find("grpc-retry-pushback-ms");
    if (found == trailing.end()) return std::string();
    return std::string(found->second.data(), found->second.size());
  };
  EXPECT_EQ(pushback(1), "10000");  // QUEUE_FULL
  EXPECT_EQ(pushback(6), "");       // TOO_MANY_POINTS
}

// ---- Cancel, Delete, Update ----

TEST(EnsembleService, ACancelledJobEndsAndKeepsItsFinishedPoints) {
  Gate gate;
  RunningServer server(
      {.factory = FakeExperiments([&gate](size_t point, uint64_t, std::stop_token stop) {
         if (point >= 2) gate.Pass(stop);
       })});
  const std::string name = server.Submit(Equilibrium(5, 10));
  gate.AwaitWaiting(2);
  ASSERT_OK(server.Cancel(name));
  EXPECT_EQ(server.AwaitEnd(name).state(), EnsembleJob::CANCELLED);
  EXPECT_EQ(server.ResultBytes(name).size(), 2u);
  EXPECT_EQ(server.Get(name).progress().points_done(), 2);
}

TEST(EnsembleService, OnlyARetryCancelsAnEndedJob) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate, 3)});
  const std::string name = server.Submit(Equilibrium(1, 100));
  ASSERT_OK(server.Cancel(name, kUuid));
  server.AwaitEnd(name);
  EXPECT_OK(server.Cancel(name, kUuid));
  const grpc::Status status = server.Cancel(name, kOtherUuid);
  EXPECT_THAT(status, IsError(grpc::StatusCode::FAILED_PRECONDITION, "JOB_ALREADY_ENDED"));
  EXPECT_THAT(status.error_message(), HasSubstr("CANCELLED"));
}

TEST(EnsembleService, OnlyAnEndedJobCanBeDeleted) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate, 3)});
  const std::string name = server.Submit(Equilibrium(1, 100));
  EXPECT_THAT(server.Delete(name),
              IsError(grpc::StatusCode::FAILED_PRECONDITION, "JOB_STILL_ACTIVE"));
  gate.Open();
  server.AwaitEnd(name);
  EXPECT_OK(server.Delete(name));
  EXPECT_THAT(server.Delete(name), IsError(grpc::StatusCode::NOT_FOUND, "JOB_NOT_FOUND"));
}

TEST(EnsembleService, AnUpdateSetsTheFieldsOfItsMask) {
  RunningServer server;
  const std::string name = server.Succeeded(Equilibrium(1, 2));
  v1::UpdateEnsembleJobRequest request = UpdateRequest(name, {"pinned"});
  request.mutable_job()->set_pinned(true);
  request.mutable_job()->set_priority(500);  // is not in the mask
  EnsembleJob job;
  EXPECT_OK(Update(server, request, &job));
  EXPECT_TRUE(job.pinned());
  EXPECT_EQ(job.priority(), 0);
  request = UpdateRequest(name, {"priority"});
  request.mutable_job()->set_priority(-7);
  EXPECT_OK(Update(server, request, &job));
  EXPECT_TRUE(job.pinned());
  EXPECT_EQ(job.priority(), -7);
  EXPECT_OK(Update(server, UpdateRequest(name, {"pinned", "priority"}), &job));
  EXPECT_FALSE(server.Get(name).pinned());
  EXPECT_EQ(server.Get(name).priority(), 0);
}

// ---- List ----

std::vector<std::string> NamesOf(const v1::ListEnsembleJobsResponse& page) {
  std::vector<std::string> names;
  for (const EnsembleJob& job : page.jobs()) names.push_back(job.name());
  return names;
}

TEST(EnsembleService, JobsAreListedNewestFirstInPages) {
  RunningServer server;
  std::vector<std::string> names;
  for (int i = 0; i < 5; ++i) names.insert(names.begin(), server.Submit(Equilibrium(1, 2)));
  std::vector<std::string> listed;
  std::vector<int> sizes;
  v1::ListEnsembleJobsRequest request;
  request.set_page_size(2);
  for (const auto& page : server.Pages(request)) {
    for (const auto& job : page.jobs()) listed.push_back(job.name());
    sizes.push_back(page.jobs_size());
  }
  EXPECT_EQ(listed, names);
  EXPECT_THAT(sizes, ElementsAre(2, 2, 1));
}

TEST(EnsembleService, PagesOfLargeJobsStayBelowTwoMebibytes) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate)});
  for (int i = 0; i < 4; ++i) server.Submit(LargeEquilibrium());
  const auto pages = server.Pages(v1::ListEnsembleJobsRequest());
  int listed = 0;
  for (const auto& page : pages) {
    EXPECT_LT(page.ByteSizeLong(), size_t{2} << 20);
    listed += page.jobs_size();
  }
  EXPECT_EQ(listed, 4);
  EXPECT_EQ(pages.size(), 2u);
}

TEST(EnsembleService, JobsAreFilteredByStateExperimentAndTime) {
  Gate gate;
  RunningServer server(
      {.workers = 1,
       .factory = FakeExperimentsBySeed([&](uint64_t seed, size_t, uint64_t, std::stop_token stop) {
         if (seed == 42) gate.Pass(stop);
       })});
  const std::string succeeded = server.Succeeded(Equilibrium(1, 2));
  const std::string running = server.Submit(SmallFirstHit());
  gate.AwaitWaiting(1);
  const std::string queued = server.Submit(Equilibrium(1, 2, 3));  // the only worker waits
  const auto listed = [&](const std::function<void(v1::ListEnsembleJobsRequest&)>& filter) {
    v1::ListEnsembleJobsRequest request;
    filter(request);
    return NamesOf(server.List(request));
  };
  EXPECT_THAT(listed([](auto&) {}), ElementsAre(queued, running, succeeded));
  EXPECT_THAT(listed([](auto& r) { r.add_states(EnsembleJob::RUNNING); }), ElementsAre(running));
  EXPECT_THAT(listed([](auto& r) {
                r.add_states(EnsembleJob::SUCCEEDED);
                r.add_states(EnsembleJob::QUEUED);
              }),
              ElementsAre(queued, succeeded));
  EXPECT_THAT(listed([](auto& r) { r.add_experiments(v1::EnsembleSpec::FIRST_HIT); }),
              ElementsAre(running));
  EXPECT_THAT(listed([&](auto& r) { *r.mutable_since() = server.Get(running).create_time(); }),
              ElementsAre(queued, running));
  EXPECT_THAT(listed([](auto& r) { r.mutable_since()->set_seconds(253'402'300'799); }),
              ElementsAre());  // the end of the year 9999
}

// The view and the size of the page may change from page to page.
TEST(EnsembleService, APageTokenIsValidOnlyWithItsFilters) {
  RunningServer server;
  const std::string oldest = server.Succeeded(Equilibrium(1, 2, 1));
  const std::string older = server.Submit(Equilibrium(1, 2, 2));
  server.Submit(Equilibrium(1, 2, 3));
  v1::ListEnsembleJobsRequest request;
  request.add_experiments(v1::EnsembleSpec::EQUILIBRIUM);
  request.set_page_size(1);
  request.set_page_token(server.List(request).next_page_token());
  request.set_page_size(2);
  request.set_view(v1::ListEnsembleJobsRequest::BASIC);
  EXPECT_THAT(NamesOf(server.List(request)), ElementsAre(older, oldest));
  v1::ListEnsembleJobsRequest states = request, experiments = request, since = request;
  states.add_states(EnsembleJob::SUCCEEDED);
  experiments.clear_experiments();
  since.mutable_since()->set_seconds(1);
  for (const auto& other : {states, experiments, since}) {
    EXPECT_THAT(DetailsOf(ListError(server, other)).fields, ElementsAre("page_token"));
  }
}

// ---- Results ----

TEST(EnsembleService, ResultsComeInGridOrderInPages) {
  RunningServer server;
  const std::string name = server.Succeeded(Equilibrium(25, 3));
  v1::ListResultsRequest request;
  request.set_parent(name);
  request.set_page_size(10);
  std::vector<int> indices;
  std::vector<int> sizes;
  for (const auto& page : server.Pages(request)) {
    for (const auto& point : page.results()) {
      indices.push_back(point.index());
      EXPECT_EQ(point.name(), absl::StrCat(name, "/results/", point.index()));
      EXPECT_EQ(point.parameters().delta(), 0.1 + 1e-6 * point.index());
    }
    sizes.push_back(page.results_size());
  }
  EXPECT_THAT(sizes, ElementsAre(10, 10, 5));
  for (int i = 0; i < 25; ++i) EXPECT_EQ(indices[static_cast<size_t>(i)], i);
}

TEST(EnsembleService, AnUnfinishedPointIsReadOnRequestOnly) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate, 3)});
  v1::GetResultRequest request;
  request.set_name(server.Submit(Equilibrium(1, 100)) + "/results/0");
  gate.AwaitWaiting(2);  // three blocks are merged; the others wait
  v1::PointResult result;
  const auto get = [&] {
    grpc::ClientContext context;
    return server.ensemble().GetResult(&context, request, &result);
  };
  EXPECT_EQ(ReasonOf(get()), "RESULT_NOT_FOUND");
  request.set_unfinished(true);
  EXPECT_OK(get());
  EXPECT_EQ(result.samples(), 3 * kFakeSamplesPerBlock);
}

TEST(EnsembleService, TheBasicViewHasNoHistograms) {
  RunningServer server({.factory = nullptr});  // the core's experiments
  const std::string name = server.Succeeded(SmallFirstHit());
  for (const auto view : {v1::ListResultsRequest::BASIC, v1::ListResultsRequest::FULL,
                          v1::ListResultsRequest::VIEW_UNSPECIFIED}) {
    v1::ListResultsRequest request;
    request.set_parent(name);
    request.set_view(view);
    const v1::ListResultsResponse response = server.Results(request);
    ASSERT_EQ(response.results_size(), 6);
    EXPECT_EQ(response.results(0).histograms().empty(), view == v1::ListResultsRequest::BASIC);
    EXPECT_GT(response.results(0).estimates_size(), 0);
    EXPECT_EQ(response.results(0).model(), v1::EnsembleSpec::BILLIARD);
  }
}

TEST(EnsembleService, PagesOfHistogramsStayBelowTwoMebibytes) {
  RunningServer server({.factory = nullptr});
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.mutable_grid()->clear_delta();
  for (int i = 0; i < 50; ++i) spec.mutable_grid()->add_delta(0.2 + 1e-3 * i);  // 100 points
  spec.mutable_target()->set_samples(64);
  const std::string name = server.Succeeded(spec);
  v1::ListResultsRequest request;
  request.set_parent(name);
  request.set_page_size(1000);
  const auto pages = server.Pages(request);
  int points = 0;
  for (const auto& page : pages) {
    EXPECT_LE(page.ByteSizeLong(), (size_t{2} << 20) + 1024);
    points += page.results_size();
  }
  EXPECT_EQ(points, 100);
  EXPECT_GT(pages.size(), 1u);
}

}  // namespace
}  // namespace ballpiston::server
