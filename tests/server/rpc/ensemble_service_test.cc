#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

// ---- Cancel, Update ----

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
  for (const auto& [update, pinned, priority] :
       {std::tuple("job { pinned: true priority: 500 } update_mask { paths: 'pinned' }", true, 0),
        {"job { priority: -7 } update_mask { paths: 'priority' }", true, -7},
        {"job {} update_mask { paths: ['pinned', 'priority'] }", false, 0}}) {
    auto request = FromText<v1::UpdateEnsembleJobRequest>(update);
    request.mutable_job()->set_name(name);
    for (const auto& job : {server.Answered<EnsembleJob>(request), server.Get(name)}) {
      EXPECT_EQ(job.pinned(), pinned);
      EXPECT_EQ(job.priority(), priority);
    }
  }
}

// ---- List ----

TEST(EnsembleService, AListByLabelsHasOnlyJobsWithAllTheseLabels) {
  RunningServer server;
  auto update = FromText<v1::UpdateEnsembleJobRequest>(
      "job { labels { key: 'a' value: '1' } labels { key: 'b' value: '2' } } "
      "update_mask { paths: 'labels' }");
  update.mutable_job()->set_name(server.Succeeded(Equilibrium(1, 2)));
  server.Answered<EnsembleJob>(update);
  for (const auto& [labels, jobs] :
       {std::pair("labels { key: 'a' value: '1' } labels { key: 'b' value: '2' }", 1),
        {"labels { key: 'b' value: '2' }", 1},
        {"labels { key: 'a' value: '2' }", 0},
        {"labels { key: 'a' value: '1' } labels { key: 'c' value: '1' }", 0}}) {
    const auto request = FromText<v1::ListEnsembleJobsRequest>(labels);
    EXPECT_EQ(server.Answered<v1::ListEnsembleJobsResponse>(request).jobs_size(), jobs) << labels;
  }
}

TEST(EnsembleService, PagesOfLargeJobsStayBelowTwoMebibytes) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate)});
  for (int i = 0; i < 4; ++i) server.Submit(LargeEquilibrium());
  const auto pages = server.Pages<v1::ListEnsembleJobsResponse>(v1::ListEnsembleJobsRequest());
  ASSERT_EQ(pages.size(), 2u);
  EXPECT_EQ(pages[0].jobs_size() + pages[1].jobs_size(), 4);
  for (const auto& page : pages) EXPECT_LT(page.ByteSizeLong(), size_t{2} << 20);
}

// bad_requests_test.cc tests that a token is not valid with other filters.
TEST(EnsembleService, SizeAndViewMayChangeFromPageToPage) {
  RunningServer server;
  for (int i = 0; i < 3; ++i) server.Submit(Equilibrium(1, 2));
  server.Submit(SmallFirstHit());  // does not match
  auto request =
      FromText<v1::ListEnsembleJobsRequest>("experiments: EQUILIBRIUM since {} page_size: 1");
  request.set_page_token(server.List(request).next_page_token());
  request.set_page_size(3);
  request.set_view(v1::ListEnsembleJobsRequest::BASIC);
  EXPECT_EQ(server.List(request).jobs_size(), 2);
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

TEST(EnsembleService, TheBasicViewOmitsHistogramsAndPagesWithHistogramsStayBelowTwoMebibytes) {
  RunningServer server({.factory = nullptr});  // the core's experiments
  v1::EnsembleSpec spec = SmallFirstHit();
  spec.mutable_grid()->clear_delta();
  for (int i = 0; i < 50; ++i) spec.mutable_grid()->add_delta(0.2 + 1e-3 * i);  // 100 points
  spec.mutable_target()->set_samples(64);
  v1::ListResultsRequest request;
  request.set_parent(server.Succeeded(spec));
  request.set_page_size(1000);
  const auto pages = server.Pages<v1::ListResultsResponse>(request);
  int points = 0;
  for (const auto& page : pages) {
    EXPECT_LE(page.ByteSizeLong(), (size_t{2} << 20) + 1024);
    points += page.results_size();
  }
  EXPECT_EQ(points, 100);
  EXPECT_GT(pages.size(), 1u);
  request.set_view(v1::ListResultsRequest::BASIC);
  const auto basic = server.Answered<v1::ListResultsResponse>(request);
  ASSERT_EQ(basic.results_size(), 100);
  EXPECT_THAT(basic.results(0).histograms(), IsEmpty());
  EXPECT_THAT(basic.results(0).estimates(), Not(IsEmpty()));
  EXPECT_EQ(basic.results(0).model(), v1::EnsembleSpec::BILLIARD);
}

}  // namespace
}  // namespace ballpiston::server
