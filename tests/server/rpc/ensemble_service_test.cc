#include <cctype>
#include <limits>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
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

constexpr char kUnknownJob[] = "ensembleJobs/unknown";

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

TEST(EnsembleService, AllViolationsAreListedWithTheirPaths) {
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.mutable_grid()->set_rho(0, 0.4);
  spec.mutable_grid()->add_delta(-1);
  spec.mutable_grid()->add_epsilon(std::numeric_limits<double>::quiet_NaN());
  spec.mutable_grid()->add_exponent(std::numeric_limits<double>::infinity());
  spec.mutable_grid()->add_cells("4x4");
  spec.mutable_grid()->add_cells("4y4");
  spec.mutable_grid()->add_cold(0);
  spec.mutable_target()->set_samples(0);
  spec.set_model(static_cast<v1::EnsembleSpec::Model>(99));
  const grpc::Status status = RunningServer().Create(CreateRequest(spec, "not a uuid"));
  EXPECT_THAT(status, IsError(grpc::StatusCode::INVALID_ARGUMENT, "INVALID_SPEC"));
  EXPECT_THAT(DetailsOf(status).fields,
              IsSupersetOf({"spec.grid.rho[0]", "spec.grid.delta[3]", "spec.grid.epsilon[2]",
                            "spec.grid.exponent[1]", "spec.grid.cells", "spec.grid.cells[1]",
                            "spec.grid.cold", "spec.grid.cold[0]", "spec.target.samples",
                            "spec.model", "request_id"}));
}

TEST(EnsembleService, AnEmptyRequestIsRefused) {
  const grpc::Status status = RunningServer().Create({});
  EXPECT_THAT(status, StatusIs(grpc::StatusCode::INVALID_ARGUMENT));
  EXPECT_THAT(DetailsOf(status).fields, IsSupersetOf({"spec.experiment"}));
}

TEST(EnsembleService, AnAbsurdGridIsRefused) {
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.mutable_grid()->clear_rho();
  spec.mutable_grid()->clear_delta();
  for (int i = 0; i < 1000; ++i) {
    spec.mutable_grid()->add_rho(0.53 + 1e-6 * i);
    spec.mutable_grid()->add_delta(0.1 + 1e-6 * i);
  }
  for (int i = 0; i < 998; ++i) spec.mutable_grid()->add_epsilon(0.1 + 1e-6 * i);
  const grpc::Status status = RunningServer().Create(CreateRequest(spec));  // 10^9 points
  EXPECT_THAT(status, StatusIs(grpc::StatusCode::INVALID_ARGUMENT));
  EXPECT_THAT(DetailsOf(status).fields, IsSupersetOf({"spec.grid"}));
}

TEST(EnsembleService, ABudgetBesideSamplesIsRefused) {
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.mutable_target()->mutable_budget()->set_seconds(5);
  const grpc::Status status = RunningServer().Create(CreateRequest(spec));
  EXPECT_THAT(status, StatusIs(grpc::StatusCode::INVALID_ARGUMENT));
  EXPECT_THAT(DetailsOf(status).fields, ElementsAre("spec.target.budget"));
}

TEST(EnsembleService, ThousandsOfViolationsArriveAsInvalidArgument) {
  v1::EnsembleSpec spec = SmallFirstHit();
  for (int i = 0; i < 10'000; ++i) spec.mutable_grid()->add_rho(-1);
  const grpc::Status status = RunningServer().Create(CreateRequest(spec));
  EXPECT_THAT(status, StatusIs(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("left out")));
}

TEST(EnsembleService, ValidateOnlyCreatesNoJob) {
  RunningServer server;
  v1::CreateEnsembleJobRequest request = CreateRequest(Equilibrium(7, 10), kUuid);
  request.set_validate_only(true);
  const EnsembleJob job = server.Created(request);
  EXPECT_EQ(job.name(), "");
  EXPECT_EQ(job.progress().points(), 7);
  EXPECT_EQ(job.state(), EnsembleJob::QUEUED);
  EXPECT_EQ(server.List().jobs_size(), 0);
}

TEST(EnsembleService, ARetryReturnsTheSameJob) {
  RunningServer server;
  const EnsembleJob first = server.Created(CreateRequest(Equilibrium(1, 5), kUuid));
  server.AwaitEnd(first.name());
  std::string upper = kUuid;
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  const EnsembleJob again = server.Created(CreateRequest(Equilibrium(1, 5), upper));
  EXPECT_EQ(again.name(), first.name());
  EXPECT_EQ(again.state(), EnsembleJob::SUCCEEDED);
}

TEST(EnsembleService, ARequestIdWithAnotherSpecIsRefused) {
  RunningServer server;
  ASSERT_OK(server.Create(CreateRequest(Equilibrium(1, 5), kUuid)));
  EXPECT_THAT(server.Create(CreateRequest(Equilibrium(1, 6), kUuid)),
              IsError(grpc::StatusCode::INVALID_ARGUMENT, "REQUEST_ID_REUSED"));
}

TEST(EnsembleService, ConcurrentCreatesWithOneRequestIdMakeOneJob) {
  RunningServer server;
  std::mutex mutex;
  std::set<std::string> names;
  std::vector<std::thread> threads;
  for (int i = 0; i < 64; ++i) {
    threads.emplace_back([&] {
      const EnsembleJob job = server.Created(CreateRequest(Equilibrium(1, 5), kUuid));
      // Each thread can watch the job at once, also if another thread's call created it.
      EXPECT_EQ(server.AwaitEnd(job.name()).state(), EnsembleJob::SUCCEEDED);
      std::lock_guard lock(mutex);
      names.insert(job.name());
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(names.size(), 1u);
  EXPECT_EQ(server.List().jobs_size(), 1);
}

TEST(EnsembleService, AnExceptionFailsTheJobOnly) {
  RunningServer server(
      {.factory = FakeExperimentsBySeed([](uint64_t seed, size_t, uint64_t, std::stop_token) {
         if (seed == 13) throw std::runtime_error("the ball left the cell");
       })});
  const EnsembleJob failed = server.AwaitEnd(server.Submit(Equilibrium(2, 5, 13)));
  EXPECT_EQ(failed.state(), EnsembleJob::FAILED);
  EXPECT_THAT(failed.error().message(), HasSubstr("the ball left the cell"));
  server.Succeeded(Equilibrium(2, 5));
}

// ---- names ----

TEST(EnsembleService, UnknownJobsAreNotFound) {
  RunningServer server;
  grpc::ClientContext get, results, watch;
  v1::GetEnsembleJobRequest get_request;
  get_request.set_name(kUnknownJob);
  EnsembleJob job;
  v1::ListResultsRequest results_request;
  results_request.set_parent(kUnknownJob);
  v1::ListResultsResponse points;
  v1::WatchEnsembleJobRequest watch_request;
  watch_request.set_name(kUnknownJob);
  for (const grpc::Status& status :
       {server.ensemble().GetEnsembleJob(&get, get_request, &job), server.Cancel(kUnknownJob),
        server.Delete(kUnknownJob),
        server.ensemble().ListResults(&results, results_request, &points),
        server.ensemble().WatchEnsembleJob(&watch, watch_request)->Finish()}) {
    EXPECT_THAT(status, IsError(grpc::StatusCode::NOT_FOUND, "JOB_NOT_FOUND"));
    EXPECT_THAT(status.error_message(), HasSubstr(kUnknownJob));
  }
}

TEST(EnsembleService, MalformedNamesAreInvalid) {
  RunningServer server;
  grpc::ClientContext get, results, watch;
  v1::GetEnsembleJobRequest get_request;
  get_request.set_name("jobs/1");
  EnsembleJob job;
  v1::ListResultsRequest results_request;
  v1::ListResultsResponse points;
  const std::vector<std::pair<grpc::Status, std::string>> answers = {
      {server.ensemble().GetEnsembleJob(&get, get_request, &job), "name"},
      {server.Cancel("ensembleJobs/"), "name"},
      {server.Delete("ensembleJobs/A B"), "name"},
      {server.ensemble().ListResults(&results, results_request, &points), "parent"},
      {server.ensemble().WatchEnsembleJob(&watch, {})->Finish(), "name"}};
  for (const auto& [status, field] : answers) {
    EXPECT_THAT(status, StatusIs(grpc::StatusCode::INVALID_ARGUMENT));
    EXPECT_THAT(DetailsOf(status).fields, ElementsAre(field));
  }
}

// ---- Cancel, Delete ----

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

TEST(EnsembleService, AnEndedJobCannotBeCancelled) {
  RunningServer server;
  const std::string name = server.Succeeded(Equilibrium(1, 5));
  const grpc::Status status = server.Cancel(name);
  EXPECT_THAT(status, IsError(grpc::StatusCode::FAILED_PRECONDITION, "JOB_ALREADY_ENDED"));
  EXPECT_THAT(status.error_message(), HasSubstr("SUCCEEDED"));
}

TEST(EnsembleService, ARetriedCancellationSucceeds) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate, 3)});
  const std::string name = server.Submit(Equilibrium(1, 100));
  ASSERT_OK(server.Cancel(name, kUuid));
  server.AwaitEnd(name);
  EXPECT_OK(server.Cancel(name, kUuid));
  const grpc::Status status = server.Cancel(name, kOtherUuid);
  EXPECT_EQ(ReasonOf(status), "JOB_ALREADY_ENDED");
  EXPECT_THAT(status.error_message(), HasSubstr("CANCELLED"));
}

TEST(EnsembleService, ACancellationsRequestIdMustBeAUuid) {
  EXPECT_THAT(DetailsOf(RunningServer().Cancel(kUnknownJob, "x")).fields,
              ElementsAre("request_id"));
}

TEST(EnsembleService, AnActiveJobCannotBeDeleted) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate, 3)});
  const std::string name = server.Submit(Equilibrium(1, 100));
  EXPECT_THAT(server.Delete(name),
              IsError(grpc::StatusCode::FAILED_PRECONDITION, "JOB_STILL_ACTIVE"));
}

TEST(EnsembleService, ADeletedJobIsGone) {
  RunningServer server;
  const std::string name = server.Succeeded(Equilibrium(1, 5));
  ASSERT_OK(server.Delete(name));
  EXPECT_THAT(server.Delete(name), StatusIs(grpc::StatusCode::NOT_FOUND));
}

// ---- List ----

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

TEST(EnsembleService, APageThatEndsWithTheListHasNoToken) {
  RunningServer server;
  for (int i = 0; i < 2; ++i) server.Submit(Equilibrium(1, 2));
  v1::ListEnsembleJobsRequest request;
  request.set_page_size(2);
  EXPECT_EQ(server.List(request).next_page_token(), "");
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

std::vector<std::string> NamesOf(const v1::ListEnsembleJobsResponse& page) {
  std::vector<std::string> names;
  for (const EnsembleJob& job : page.jobs()) names.push_back(job.name());
  return names;
}

TEST(EnsembleService, JobsAreFilteredByTheirPresentState) {
  Gate gate;
  RunningServer server(
      {.workers = 1,
       .factory = FakeExperimentsBySeed([&](uint64_t seed, size_t, uint64_t, std::stop_token stop) {
         if (seed == 2) gate.Pass(stop);
       })});
  const std::string succeeded = server.Succeeded(Equilibrium(1, 2));
  const std::string running = server.Submit(Equilibrium(1, 2, 2));
  gate.AwaitWaiting(1);
  const std::string queued = server.Submit(Equilibrium(1, 2, 3));  // the only worker waits
  const auto listed = [&](const std::vector<EnsembleJob::State>& states) {
    v1::ListEnsembleJobsRequest request;
    for (const EnsembleJob::State state : states) request.add_states(state);
    return NamesOf(server.List(request));
  };
  EXPECT_THAT(listed({}), ElementsAre(queued, running, succeeded));
  EXPECT_THAT(listed({EnsembleJob::QUEUED}), ElementsAre(queued));
  EXPECT_THAT(listed({EnsembleJob::RUNNING}), ElementsAre(running));
  EXPECT_THAT(listed({EnsembleJob::SUCCEEDED, EnsembleJob::QUEUED, EnsembleJob::QUEUED}),
              ElementsAre(queued, succeeded));
  EXPECT_THAT(listed({EnsembleJob::FAILED}), ElementsAre());
}

TEST(EnsembleService, JobsAreFilteredByExperiment) {
  RunningServer server;
  const std::string equilibrium = server.Submit(Equilibrium(1, 2));
  const std::string first_hit = server.Submit(SmallFirstHit());
  const auto listed = [&](const std::vector<v1::EnsembleSpec::Experiment>& experiments) {
    v1::ListEnsembleJobsRequest request;
    for (const auto experiment : experiments) request.add_experiments(experiment);
    return NamesOf(server.List(request));
  };
  EXPECT_THAT(listed({v1::EnsembleSpec::EQUILIBRIUM}), ElementsAre(equilibrium));
  EXPECT_THAT(listed({v1::EnsembleSpec::FIRST_HIT}), ElementsAre(first_hit));
  EXPECT_THAT(listed({v1::EnsembleSpec::FIRST_HIT, v1::EnsembleSpec::EQUILIBRIUM}),
              ElementsAre(first_hit, equilibrium));
  EXPECT_THAT(listed({v1::EnsembleSpec::MARKOV_PROPERTY}), ElementsAre());
}

TEST(EnsembleService, JobsAreFilteredByTheirTimeOfCreation) {
  RunningServer server;
  std::vector<EnsembleJob> jobs;
  for (const int points : {1, 2, 3}) {
    jobs.push_back(server.Created(CreateRequest(Equilibrium(points, 2))));
  }
  v1::ListEnsembleJobsRequest request;
  *request.mutable_since() = jobs[1].create_time();
  EXPECT_THAT(NamesOf(server.List(request)), ElementsAre(jobs[2].name(), jobs[1].name()));
  request.mutable_since()->set_seconds(253'402'300'799);  // the end of the year 9999
  EXPECT_THAT(NamesOf(server.List(request)), ElementsAre());
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
  const auto refused = [&server](const v1::ListEnsembleJobsRequest& other) {
    grpc::ClientContext context;
    v1::ListEnsembleJobsResponse response;
    return server.ensemble().ListEnsembleJobs(&context, other, &response);
  };
  v1::ListEnsembleJobsRequest states = request, experiments = request, since = request;
  states.add_states(EnsembleJob::SUCCEEDED);
  experiments.clear_experiments();
  since.mutable_since()->set_seconds(1);
  for (const auto& other : {states, experiments, since}) {
    EXPECT_THAT(refused(other), IsError(grpc::StatusCode::INVALID_ARGUMENT, "INVALID_REQUEST"));
    EXPECT_THAT(DetailsOf(refused(other)).fields, ElementsAre("page_token"));
  }
}

TEST(EnsembleService, WrongFiltersAreRefusedWithWhatIsPermitted) {
  RunningServer server;
  v1::ListEnsembleJobsRequest request;
  request.add_states(EnsembleJob::RUNNING);
  request.add_states(EnsembleJob::STATE_UNSPECIFIED);
  request.add_states(static_cast<EnsembleJob::State>(7));
  request.add_experiments(v1::EnsembleSpec::EXPERIMENT_UNSPECIFIED);
  request.add_experiments(static_cast<v1::EnsembleSpec::Experiment>(-1));
  request.mutable_since()->set_seconds(253'402'300'800);
  request.mutable_since()->set_nanos(-1);
  const auto refused = [&] {
    grpc::ClientContext context;
    v1::ListEnsembleJobsResponse response;
    return server.ensemble().ListEnsembleJobs(&context, request, &response);
  };
  EXPECT_THAT(refused(), IsError(grpc::StatusCode::INVALID_ARGUMENT, "INVALID_REQUEST"));
  EXPECT_THAT(refused().error_message(),
              HasSubstr("states[1]: is 0; permitted: QUEUED, RUNNING, CANCELLING, SUCCEEDED, "
                        "FAILED, CANCELLED"));
  EXPECT_THAT(DetailsOf(refused()).fields,
              ElementsAre("states[1]", "states[2]", "experiments[0]", "experiments[1]",
                          "since.seconds", "since.nanos"));
  request.clear_states();
  request.clear_experiments();
  EXPECT_THAT(refused().error_message(),
              HasSubstr("since.seconds: is 253402300800; permitted: -62135596800 to "
                        "253402300799"));
}

TEST(EnsembleService, MillionsOfWrongFiltersAreRefused) {
  RunningServer server;
  v1::ListEnsembleJobsRequest request;
  for (int i = 0; i < 4'000'000; ++i) request.add_states(EnsembleJob::STATE_UNSPECIFIED);
  grpc::ClientContext context;
  v1::ListEnsembleJobsResponse response;
  EXPECT_THAT(server.ensemble().ListEnsembleJobs(&context, request, &response),
              StatusIs(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("(and 99 more)")));
}

TEST(EnsembleService, BadPagesAreRefused) {
  RunningServer server;
  const std::string name = server.Submit(Equilibrium(1, 2));
  for (const char* token : {"x", "!!!", "am9iczotMQ==", "cmVzdWx0czphOjE="}) {
    grpc::ClientContext context;
    v1::ListEnsembleJobsRequest request;
    request.set_page_size(-1);
    request.set_page_token(token);
    v1::ListEnsembleJobsResponse response;
    const grpc::Status status = server.ensemble().ListEnsembleJobs(&context, request, &response);
    EXPECT_THAT(status, StatusIs(grpc::StatusCode::INVALID_ARGUMENT));
    EXPECT_THAT(DetailsOf(status).fields, ElementsAre("page_size", "page_token")) << token;
  }
  grpc::ClientContext context;
  v1::ListResultsRequest request;
  request.set_parent(name);
  request.set_page_size(-5);
  request.set_page_token("x");
  request.set_view(static_cast<v1::ListResultsRequest::View>(9));
  v1::ListResultsResponse response;
  EXPECT_THAT(DetailsOf(server.ensemble().ListResults(&context, request, &response)).fields,
              ElementsAre("page_size", "page_token", "view"));
}

// ---- Updates ----

grpc::Status Update(RunningServer& server, const v1::UpdateEnsembleJobRequest& request,
                    EnsembleJob* job = nullptr) {
  grpc::ClientContext context;
  EnsembleJob answer;
  const grpc::Status status =
      server.ensemble().UpdateEnsembleJob(&context, request, job == nullptr ? &answer : job);
  return status;
}

v1::UpdateEnsembleJobRequest UpdateRequest(const std::string& name,
                                           const std::vector<std::string>& paths) {
  v1::UpdateEnsembleJobRequest request;
  request.mutable_job()->set_name(name);
  for (const std::string& path : paths) request.mutable_update_mask()->add_paths(path);
  return request;
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
  EXPECT_OK(Update(server, UpdateRequest(name, {"pinned", "priority"})));
  EXPECT_FALSE(server.Get(name).pinned());
  EXPECT_EQ(server.Get(name).priority(), 0);
}

TEST(EnsembleService, WrongMasksAreRefusedWithWhatIsPermitted) {
  RunningServer server;
  const std::string name = server.Submit(Equilibrium(1, 2));
  const std::vector<std::vector<std::string>> masks = {
      {}, {"*"}, {"spec"}, {"pinned", "state"}, {"job.pinned"}, {""}};
  for (const auto& paths : masks) {
    const grpc::Status status = Update(server, UpdateRequest(name, paths));
    EXPECT_THAT(status, StatusIs(grpc::StatusCode::INVALID_ARGUMENT,
                                 HasSubstr("permitted: pinned, priority")));
    EXPECT_THAT(DetailsOf(status).fields, ElementsAre("update_mask"));
  }
  v1::UpdateEnsembleJobRequest request = UpdateRequest("jobs/1", {"priority"});
  request.mutable_job()->set_priority(101);
  EXPECT_THAT(DetailsOf(Update(server, request)).fields, ElementsAre("job.name", "job.priority"));
  EXPECT_EQ(ReasonOf(Update(server, UpdateRequest("ensembleJobs/none", {"pinned"}))),
            "JOB_NOT_FOUND");
}

// ---- Errors ----

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
