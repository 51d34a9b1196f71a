#include <atomic>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <thread>

#include "gmock/gmock.h"
#include "grpcpp/create_channel.h"
#include "gtest/gtest.h"
#include "tests/server/fake_experiments.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using v1::EnsembleJob;

constexpr char kUuid[] = "123e4567-e89b-12d3-a456-426614174000";
constexpr char kOtherUuid[] = "123e4567-e89b-12d3-a456-426614174001";
constexpr char kUnknown[] = "ensembleJobs/unknown";

class EnsembleServiceTest : public testing::Test {
 protected:
  ~EnsembleServiceTest() override { gate_.Open(); }

  // Fake experiments; blocks from `held_from` on wait at the gate.
  RunningServer& Start(uint64_t held_from = std::numeric_limits<uint64_t>::max()) {
    return StartWith(
        FakeExperiments([this, held_from](size_t, uint64_t block, std::stop_token stop) {
          if (block >= held_from) gate_.Pass(stop);
        }));
  }

  RunningServer& StartWith(ExperimentFactory factory) {
    ServerOptions options;
    options.data_dir = folder_.File("data");
    options.workers = 2;
    options.factory = std::move(factory);
    options.watch.snapshot = std::chrono::milliseconds(5);
    server_.emplace(options);
    return *server_;
  }

  Gate gate_;
  TemporaryFolder folder_;
  std::optional<RunningServer> server_;
};

v1::CreateEnsembleJobRequest Request(const v1::EnsembleSpec& spec,
                                     const std::string& request_id = "") {
  v1::CreateEnsembleJobRequest request;
  *request.mutable_spec() = spec;
  request.set_request_id(request_id);
  return request;
}

// ---- Create ----

TEST_F(EnsembleServiceTest, AJobRunsToItsEnd) {
  RunningServer& server = Start();
  EnsembleJob made;
  ASSERT_TRUE(server.Create(Request(Equilibrium(3, 10)), &made).ok());
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
  EXPECT_EQ(server.Get(made.name()).SerializeAsString(), ended.SerializeAsString());
}

TEST_F(EnsembleServiceTest, EveryViolationIsToldAtOnceWithItsPath) {
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.mutable_grid()->set_rho(0, 0.4);
  spec.mutable_grid()->add_delta(-1);
  spec.mutable_grid()->add_epsilon(std::numeric_limits<double>::quiet_NaN());
  spec.mutable_grid()->add_exponent(std::numeric_limits<double>::infinity());
  spec.mutable_target()->set_samples(0);
  spec.set_model(static_cast<v1::EnsembleSpec::Model>(99));
  EnsembleJob job;
  const grpc::Status status = Start().Create(Request(spec, "not a uuid"), &job);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(DetailsOf(status).reason, "INVALID_SPEC");
  EXPECT_THAT(
      DetailsOf(status).fields,
      IsSupersetOf({"spec.grid.rho[0]", "spec.grid.delta[3]", "spec.grid.epsilon[2]",
                    "spec.grid.exponent[1]", "spec.target.samples", "spec.model", "request_id"}));
}

TEST_F(EnsembleServiceTest, AnEmptyRequestIsRefused) {
  EnsembleJob job;
  const grpc::Status status = Start().Create({}, &job);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(DetailsOf(status).fields, IsSupersetOf({"spec.experiment"}));
}

TEST_F(EnsembleServiceTest, AnAbsurdGridIsRefused) {
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.mutable_grid()->clear_rho();
  spec.mutable_grid()->clear_delta();
  for (int i = 0; i < 1000; ++i) {
    spec.mutable_grid()->add_rho(0.53 + 1e-6 * i);
    spec.mutable_grid()->add_delta(0.1 + 1e-6 * i);
  }
  for (int i = 0; i < 998; ++i) spec.mutable_grid()->add_epsilon(0.1 + 1e-6 * i);
  EnsembleJob job;
  const grpc::Status status = Start().Create(Request(spec), &job);  // 10^9 points
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(DetailsOf(status).fields, IsSupersetOf({"spec.grid"}));
}

TEST_F(EnsembleServiceTest, ABudgetBesideSamplesIsRefused) {
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.mutable_target()->mutable_budget()->set_seconds(5);
  EnsembleJob job;
  const grpc::Status status = Start().Create(Request(spec), &job);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(DetailsOf(status).fields, ElementsAre("spec.target.budget"));
}

TEST_F(EnsembleServiceTest, ThousandsOfViolationsArriveAsInvalidArgument) {
  v1::EnsembleSpec spec = SmallFirstHit();
  for (int i = 0; i < 10'000; ++i) spec.mutable_grid()->add_rho(-1);
  EnsembleJob job;
  const grpc::Status status = Start().Create(Request(spec), &job);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("left out"));
}

TEST_F(EnsembleServiceTest, ValidateOnlyMakesNothing) {
  RunningServer& server = Start();
  v1::CreateEnsembleJobRequest request = Request(Equilibrium(7, 10), kUuid);
  request.set_validate_only(true);
  EnsembleJob job;
  ASSERT_TRUE(server.Create(request, &job).ok());
  EXPECT_EQ(job.name(), "");
  EXPECT_EQ(job.progress().points(), 7);
  EXPECT_EQ(job.state(), EnsembleJob::QUEUED);
  grpc::ClientContext context;
  v1::ListEnsembleJobsResponse list;
  ASSERT_TRUE(server.ensemble().ListEnsembleJobs(&context, {}, &list).ok());
  EXPECT_EQ(list.jobs_size(), 0);
}

TEST_F(EnsembleServiceTest, AReplayReturnsTheSameJob) {
  RunningServer& server = Start();
  EnsembleJob first, again;
  ASSERT_TRUE(server.Create(Request(Equilibrium(1, 5), kUuid), &first).ok());
  server.AwaitEnd(first.name());
  std::string upper = kUuid;
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  ASSERT_TRUE(server.Create(Request(Equilibrium(1, 5), upper), &again).ok());
  EXPECT_EQ(again.name(), first.name());
  EXPECT_EQ(again.state(), EnsembleJob::SUCCEEDED);
}

TEST_F(EnsembleServiceTest, ARequestIdWithAnotherSpecIsRefused) {
  RunningServer& server = Start();
  EnsembleJob job;
  ASSERT_TRUE(server.Create(Request(Equilibrium(1, 5), kUuid), &job).ok());
  const grpc::Status status = server.Create(Request(Equilibrium(1, 6), kUuid), &job);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(DetailsOf(status).reason, "REQUEST_ID_REUSED");
}

TEST_F(EnsembleServiceTest, ConcurrentCreatesWithOneRequestIdMakeOneJob) {
  RunningServer& server = Start();
  std::mutex mutex;
  std::set<std::string> names;
  std::vector<std::thread> threads;
  for (int i = 0; i < 64; ++i) {
    threads.emplace_back([&] {
      EnsembleJob job;
      const grpc::Status status = server.Create(Request(Equilibrium(1, 5), kUuid), &job);
      EXPECT_TRUE(status.ok()) << status.error_message();
      // It can be watched at once, whoever made it.
      EXPECT_EQ(server.AwaitEnd(job.name()).state(), EnsembleJob::SUCCEEDED);
      std::lock_guard lock(mutex);
      names.insert(job.name());
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(names.size(), 1u);
  grpc::ClientContext context;
  v1::ListEnsembleJobsResponse list;
  ASSERT_TRUE(server.ensemble().ListEnsembleJobs(&context, {}, &list).ok());
  EXPECT_EQ(list.jobs_size(), 1);
}

TEST_F(EnsembleServiceTest, AnExceptionFailsTheJobAndTheServerStays) {
  RunningServer& server =
      StartWith([](const EnsembleSpec& spec, size_t index, const std::stop_token& stop) {
        return FakeExperiments([seed = spec.seed](size_t, uint64_t, std::stop_token) {
          if (seed == 13) throw std::runtime_error("the ball left the cell");
        })(spec, index, stop);
      });
  v1::EnsembleSpec bad = Equilibrium(2, 5);
  bad.set_seed(13);
  const EnsembleJob failed = server.AwaitEnd(server.Submit(bad));
  EXPECT_EQ(failed.state(), EnsembleJob::FAILED);
  EXPECT_THAT(failed.error().message(), HasSubstr("the ball left the cell"));
  EXPECT_EQ(server.AwaitEnd(server.Submit(Equilibrium(2, 5))).state(), EnsembleJob::SUCCEEDED);
}

// ---- names ----

TEST_F(EnsembleServiceTest, UnknownJobsAreNotFound) {
  RunningServer& server = Start();
  grpc::ClientContext get, results, watch;
  v1::GetEnsembleJobRequest get_request;
  get_request.set_name(kUnknown);
  EnsembleJob job;
  v1::ListResultsRequest results_request;
  results_request.set_parent(kUnknown);
  v1::ListResultsResponse points;
  v1::WatchEnsembleJobRequest watch_request;
  watch_request.set_name(kUnknown);
  for (const grpc::Status& status :
       {server.ensemble().GetEnsembleJob(&get, get_request, &job), server.Cancel(kUnknown),
        server.Delete(kUnknown), server.ensemble().ListResults(&results, results_request, &points),
        server.ensemble().WatchEnsembleJob(&watch, watch_request)->Finish()}) {
    EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
    EXPECT_EQ(DetailsOf(status).reason, "JOB_NOT_FOUND");
    EXPECT_THAT(status.error_message(), HasSubstr(kUnknown));
  }
}

TEST_F(EnsembleServiceTest, MalformedNamesAreInvalid) {
  RunningServer& server = Start();
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
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(DetailsOf(status).fields, ElementsAre(field));
  }
}

// ---- Cancel, Delete ----

TEST_F(EnsembleServiceTest, ACancelledJobEndsAndKeepsWhatItFinished) {
  RunningServer& server =
      StartWith(FakeExperiments([this](size_t point, uint64_t, std::stop_token stop) {
        if (point >= 2) gate_.Pass(stop);
      }));
  const std::string name = server.Submit(Equilibrium(5, 10));
  gate_.AwaitWaiting(2);
  ASSERT_TRUE(server.Cancel(name).ok());
  EXPECT_EQ(server.AwaitEnd(name).state(), EnsembleJob::CANCELLED);
  EXPECT_EQ(server.ResultBytes(name).size(), 2u);
  EXPECT_EQ(server.Get(name).progress().points_done(), 2);
}

TEST_F(EnsembleServiceTest, AnEndedJobCannotBeCancelled) {
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(1, 5));
  server.AwaitEnd(name);
  const grpc::Status status = server.Cancel(name);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_EQ(DetailsOf(status).reason, "JOB_ALREADY_ENDED");
  EXPECT_THAT(status.error_message(), HasSubstr("SUCCEEDED"));
}

TEST_F(EnsembleServiceTest, AReplayedCancellationSucceeds) {
  RunningServer& server = Start(3);
  const std::string name = server.Submit(Equilibrium(1, 100));
  ASSERT_TRUE(server.Cancel(name, kUuid).ok());
  server.AwaitEnd(name);
  EXPECT_TRUE(server.Cancel(name, kUuid).ok());
  const grpc::Status status = server.Cancel(name, kOtherUuid);
  EXPECT_EQ(DetailsOf(status).reason, "JOB_ALREADY_ENDED");
  EXPECT_THAT(status.error_message(), HasSubstr("CANCELLED"));
}

TEST_F(EnsembleServiceTest, ACancellationsRequestIdHasToBeAUuid) {
  EXPECT_THAT(DetailsOf(Start().Cancel(kUnknown, "x")).fields, ElementsAre("request_id"));
}

TEST_F(EnsembleServiceTest, AnActiveJobCannotBeDeleted) {
  RunningServer& server = Start(3);
  const std::string name = server.Submit(Equilibrium(1, 100));
  const grpc::Status status = server.Delete(name);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_EQ(DetailsOf(status).reason, "JOB_STILL_ACTIVE");
}

TEST_F(EnsembleServiceTest, ADeletedJobIsGone) {
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(1, 5));
  server.AwaitEnd(name);
  ASSERT_TRUE(server.Delete(name).ok());
  EXPECT_EQ(server.Delete(name).error_code(), grpc::StatusCode::NOT_FOUND);
}

// ---- List ----

TEST_F(EnsembleServiceTest, JobsAreListedNewestFirstInPages) {
  RunningServer& server = Start();
  std::vector<std::string> names;
  for (int i = 0; i < 5; ++i) names.insert(names.begin(), server.Submit(Equilibrium(1, 2)));
  std::vector<std::string> listed;
  std::vector<int> sizes;
  v1::ListEnsembleJobsRequest request;
  request.set_page_size(2);
  do {
    grpc::ClientContext context;
    v1::ListEnsembleJobsResponse response;
    ASSERT_TRUE(server.ensemble().ListEnsembleJobs(&context, request, &response).ok());
    for (const auto& job : response.jobs()) listed.push_back(job.name());
    sizes.push_back(response.jobs_size());
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  EXPECT_EQ(listed, names);
  EXPECT_THAT(sizes, ElementsAre(2, 2, 1));
}

TEST_F(EnsembleServiceTest, APageThatEndsWithTheListHasNoToken) {
  RunningServer& server = Start();
  for (int i = 0; i < 2; ++i) server.Submit(Equilibrium(1, 2));
  grpc::ClientContext context;
  v1::ListEnsembleJobsRequest request;
  request.set_page_size(2);
  v1::ListEnsembleJobsResponse response;
  ASSERT_TRUE(server.ensemble().ListEnsembleJobs(&context, request, &response).ok());
  EXPECT_EQ(response.next_page_token(), "");
}

TEST_F(EnsembleServiceTest, PagesOfLargeJobsStayBelowTwoMebibytes) {
  RunningServer& server = Start(0);
  v1::EnsembleSpec large = Equilibrium(0, 1);
  for (int i = 0; i < 90'000; ++i) large.mutable_grid()->add_delta(0.1 + 1e-7 * i);  // 720 kB
  for (int i = 0; i < 4; ++i) server.Submit(large);
  v1::ListEnsembleJobsRequest request;
  int listed = 0;
  int pages = 0;
  do {
    grpc::ClientContext context;
    v1::ListEnsembleJobsResponse response;
    ASSERT_TRUE(server.ensemble().ListEnsembleJobs(&context, request, &response).ok());
    EXPECT_LT(response.ByteSizeLong(), size_t{2} << 20);
    listed += response.jobs_size();
    ++pages;
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  EXPECT_EQ(listed, 4);
  EXPECT_EQ(pages, 2);
}

TEST_F(EnsembleServiceTest, BadPagesAreRefused) {
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(1, 2));
  for (const char* token : {"x", "!!!", "am9iczotMQ==", "cmVzdWx0czphOjE="}) {
    grpc::ClientContext context;
    v1::ListEnsembleJobsRequest request;
    request.set_page_size(-1);
    request.set_page_token(token);
    v1::ListEnsembleJobsResponse response;
    const grpc::Status status = server.ensemble().ListEnsembleJobs(&context, request, &response);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
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

// ---- Results ----

TEST_F(EnsembleServiceTest, ResultsComeInGridOrderInPages) {
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(25, 3));
  server.AwaitEnd(name);
  v1::ListResultsRequest request;
  request.set_parent(name);
  request.set_page_size(10);
  std::vector<int> indices;
  std::vector<int> sizes;
  do {
    grpc::ClientContext context;
    v1::ListResultsResponse response;
    ASSERT_TRUE(server.ensemble().ListResults(&context, request, &response).ok());
    for (const auto& point : response.points()) {
      indices.push_back(point.index());
      EXPECT_EQ(point.parameters().delta(), 0.1 + 1e-6 * point.index());
    }
    sizes.push_back(response.points_size());
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  EXPECT_THAT(sizes, ElementsAre(10, 10, 5));
  for (int i = 0; i < 25; ++i) EXPECT_EQ(indices[static_cast<size_t>(i)], i);
}

TEST_F(EnsembleServiceTest, TheBasicViewHasNoHistograms) {
  RunningServer& server = StartWith(nullptr);  // the core's experiments
  const std::string name = server.Submit(SmallFirstHit());
  ASSERT_EQ(server.AwaitEnd(name).state(), EnsembleJob::SUCCEEDED);
  for (const auto view : {v1::ListResultsRequest::BASIC, v1::ListResultsRequest::FULL,
                          v1::ListResultsRequest::VIEW_UNSPECIFIED}) {
    grpc::ClientContext context;
    v1::ListResultsRequest request;
    request.set_parent(name);
    request.set_view(view);
    v1::ListResultsResponse response;
    ASSERT_TRUE(server.ensemble().ListResults(&context, request, &response).ok());
    ASSERT_EQ(response.points_size(), 6);
    EXPECT_EQ(response.points(0).histograms().empty(), view == v1::ListResultsRequest::BASIC);
    EXPECT_GT(response.points(0).estimates_size(), 0);
    EXPECT_EQ(response.points(0).model(), v1::EnsembleSpec::BILLIARD);
  }
}

TEST_F(EnsembleServiceTest, PagesOfHistogramsStayBelowTwoMebibytes) {
  RunningServer& server = StartWith(nullptr);
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.mutable_grid()->clear_delta();
  for (int i = 0; i < 50; ++i) spec.mutable_grid()->add_delta(0.2 + 1e-3 * i);  // 100 points
  spec.mutable_target()->set_samples(64);
  const std::string name = server.Submit(spec);
  ASSERT_EQ(server.AwaitEnd(name).state(), EnsembleJob::SUCCEEDED);
  v1::ListResultsRequest request;
  request.set_parent(name);
  request.set_page_size(1000);
  int points = 0;
  int pages = 0;
  do {
    grpc::ClientContext context;
    v1::ListResultsResponse response;
    ASSERT_TRUE(server.ensemble().ListResults(&context, request, &response).ok());
    EXPECT_LE(response.ByteSizeLong(), (size_t{2} << 20) + 1024);
    points += response.points_size();
    ++pages;
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  EXPECT_EQ(points, 100);
  EXPECT_GT(pages, 1);
}

}  // namespace
}  // namespace ballpiston::server
