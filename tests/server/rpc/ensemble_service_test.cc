#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

// ---- Cancel, Delete, Update ----

TEST(EnsembleService, OnlyARetryCancelsAnEndedJob) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate, 3)});
  const std::string name = server.Submit(Equilibrium(1, 100));
  ASSERT_OK(server.Cancel(name, kUuid));
  server.AwaitEnd(name);
  // The second one may have been accepted after the first one, when the job was CANCELLING.
  for (const char* accepted : {kUuid, kOtherUuid}) EXPECT_OK(server.Cancel(name, accepted));
  const grpc::Status status = server.Cancel(name);
  EXPECT_THAT(status, IsError(grpc::StatusCode::FAILED_PRECONDITION, "JOB_ALREADY_ENDED"));
  EXPECT_THAT(status.error_message(), HasSubstr("CANCELLED"));
}

TEST(EnsembleService, AnUpdateSetsTheFieldsOfItsMask) {
  RunningServer server;
  const std::string name = server.Succeeded(Equilibrium(1, 2));
  const struct {
    std::vector<std::string> mask;
    bool pinned, is_pinned;
    int priority, has_priority;
  } rows[] = {{{"pinned"}, true, true, 500, 0},
              {{"priority"}, false, true, -7, -7},
              {{"pinned", "priority"}, false, false, 0, 0}};
  for (const auto& row : rows) {
    v1::UpdateEnsembleJobRequest request;
    request.mutable_job()->set_name(name);
    request.mutable_job()->set_pinned(row.pinned);
    request.mutable_job()->set_priority(row.priority);
    for (const std::string& path : row.mask) request.mutable_update_mask()->add_paths(path);
    const auto job = server.Answered<EnsembleJob>(request);
    EXPECT_EQ(job.pinned(), row.is_pinned);
    EXPECT_EQ(job.priority(), row.has_priority);
    EXPECT_EQ(server.Get(name).pinned(), row.is_pinned);
  }
}

// ---- List ----

std::vector<std::string> NamesOf(const v1::ListEnsembleJobsResponse& page) {
  std::vector<std::string> names;
  for (const EnsembleJob& job : page.jobs()) names.push_back(job.name());
  return names;
}

TEST(EnsembleService, PagesOfLargeJobsStayBelowTwoMebibytes) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate)});
  for (int i = 0; i < 4; ++i) server.Submit(LargeEquilibrium());
  const auto pages = server.Pages<v1::ListEnsembleJobsResponse>(v1::ListEnsembleJobsRequest());
  int listed = 0;
  for (const auto& page : pages) {
    EXPECT_LT(page.ByteSizeLong(), size_t{2} << 20);
    listed += page.jobs_size();
  }
  EXPECT_EQ(listed, 4);
  EXPECT_EQ(pages.size(), 2u);
}

// The view and the size of the page may change from page to page.
TEST(EnsembleService, JobsAreFilteredAndAPageTokenIsValidOnlyWithItsFilters) {
  RunningServer server;
  const std::string oldest = server.Succeeded(Equilibrium(1, 2, 1));
  server.Succeeded(SmallFirstHit());
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
    EXPECT_THAT(DetailsOf(server.Call(other)).fields, ElementsAre("page_token"));
  }
  v1::ListEnsembleJobsRequest failed;
  failed.add_states(EnsembleJob::FAILED);
  EXPECT_THAT(NamesOf(server.List(failed)), IsEmpty());
}

// ---- Results ----

TEST(EnsembleService, AnUnfinishedPointIsReadOnRequestOnly) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate, 3)});
  v1::GetResultRequest request;
  request.set_name(server.Submit(Equilibrium(1, 100)) + "/results/0");
  gate.AwaitWaiting(2);  // three blocks are merged; the others wait
  EXPECT_EQ(ReasonOf(server.Call(request)), "RESULT_NOT_FOUND");
  request.set_unfinished(true);
  EXPECT_EQ(server.Answered<v1::PointResult>(request).samples(), 3 * kFakeSamplesPerBlock);
}

TEST(EnsembleService, TheBasicViewHasNoHistograms) {
  RunningServer server({.factory = nullptr});  // the core's experiments
  const std::string name = server.Succeeded(SmallFirstHit());
  for (const auto view : {v1::ListResultsRequest::BASIC, v1::ListResultsRequest::FULL,
                          v1::ListResultsRequest::VIEW_UNSPECIFIED}) {
    v1::ListResultsRequest request;
    request.set_parent(name);
    request.set_view(view);
    const auto response = server.Answered<v1::ListResultsResponse>(request);
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
  const auto pages = server.Pages<v1::ListResultsResponse>(request);
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
