#include "client/library/ensemble_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "client/library/error_text.h"
#include "client/library/request_id.h"
#include "tests/client/fake_server.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(RequestId, IsARandomUuid) {
  constexpr char kUuid[] = "[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}";
  std::set<std::string> ids;
  for (int i = 0; i < 1000; ++i) {
    ids.insert(NewRequestId());
    EXPECT_THAT(NewRequestId(), ::testing::MatchesRegex(kUuid));
  }
  EXPECT_EQ(ids.size(), 1000u);
}

class EnsembleClientTest : public ::testing::Test {
 protected:
  EnsembleClientTest() { server_.ensemble.jobs = {JobIn(v1::EnsembleJob::QUEUED)}; }

  EnsembleClient StartServer() {
    server_.Start();
    return EnsembleClient(server_.Channel());
  }

  FakeServer server_;
};

// The channel repeats the call. The server recognises the repetition by the request id.
TEST_F(EnsembleClientTest, CreateIsRepeatedWithTheSameRequestId) {
  server_.ensemble.unavailable_attempts = 2;
  v1::EnsembleSpec spec;
  spec.set_seed(7);
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleJob job, StartServer().Create(spec));
  EXPECT_EQ(job.name(), kJobName);
  const auto requests = server_.ensemble.Asked().create;
  ASSERT_EQ(requests.size(), 3u);
  EXPECT_EQ(requests[0].request_id(), requests[2].request_id());
  EXPECT_EQ(requests[2].spec().seed(), 7u);
}

TEST_F(EnsembleClientTest, EachCreateHasANewRequestId) {
  const EnsembleClient client = StartServer();
  ASSERT_OK(client.Create(v1::EnsembleSpec()));
  ASSERT_OK(client.Create(v1::EnsembleSpec()));
  EXPECT_NE(server_.ensemble.Asked().create[0].request_id(),
            server_.ensemble.Asked().create[1].request_id());
}

TEST_F(EnsembleClientTest, CreateSendsItsOptions) {
  const EnsembleClient client = StartServer();
  ASSERT_OK(client.Create(v1::EnsembleSpec()));
  ASSERT_OK(client.Create(v1::EnsembleSpec(), {.request_id = "id", .fresh = true, .priority = -7}));
  const auto asked = server_.ensemble.Asked().create;
  EXPECT_FALSE(asked[0].fresh());
  EXPECT_EQ(asked[0].priority(), 0);
  EXPECT_EQ(asked[1].request_id(), "id");
  EXPECT_TRUE(asked[1].fresh());
  EXPECT_EQ(asked[1].priority(), -7);
}

TEST_F(EnsembleClientTest, ListGathersAllPages) {
  for (int i = 1; i < 5; ++i) server_.ensemble.jobs.push_back(JobIn(v1::EnsembleJob::QUEUED));
  for (size_t i = 0; i < 5; ++i) server_.ensemble.jobs[i].set_name(std::to_string(i));
  ASSERT_OK_AND_ASSIGN(const auto jobs, StartServer().List());
  ASSERT_EQ(jobs.size(), 5u);
  for (size_t i = 0; i < 5; ++i) EXPECT_EQ(jobs[i].name(), std::to_string(i));
}

TEST_F(EnsembleClientTest, ResultsGathersAllPagesInTheRequestedView) {
  for (int i = 0; i < 5; ++i) server_.ensemble.points.emplace_back().set_index(i);
  ASSERT_OK_AND_ASSIGN(const auto points,
                       StartServer().Results("ensembleJobs/a", v1::ListResultsRequest::BASIC));
  ASSERT_EQ(points.size(), 5u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(points[static_cast<size_t>(i)].index(), i);
  const auto asked = server_.ensemble.Asked().results;
  ASSERT_EQ(asked.size(), 3u);
  for (const auto& request : asked) {
    EXPECT_EQ(request.parent(), "ensembleJobs/a");
    EXPECT_EQ(request.view(), v1::ListResultsRequest::BASIC);
  }
}

TEST_F(EnsembleClientTest, ErrorsKeepCodeAndReason) {
  const auto job = StartServer().Get("ensembleJobs/none");
  EXPECT_THAT(
      job, StatusIs(absl::StatusCode::kNotFound, "no such job: ensembleJobs/none (JOB_NOT_FOUND)"));
  EXPECT_EQ(ErrorReason(job.status()), "JOB_NOT_FOUND");
}

TEST_F(EnsembleClientTest, WithoutAServerIsUnavailable) {
  const EnsembleClient client(server_.Channel());  // the server is not started
  EXPECT_THAT(client.List(), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_THAT(client.Delete("ensembleJobs/a"), StatusIs(absl::StatusCode::kUnavailable));
}

TEST_F(EnsembleClientTest, CancelSendsARequestId) {
  ASSERT_OK(StartServer().Cancel("ensembleJobs/a"));
  const auto asked = server_.ensemble.Asked().cancel;
  ASSERT_EQ(asked.size(), 1u);
  EXPECT_EQ(asked[0].name(), "ensembleJobs/a");
  EXPECT_NE(asked[0].request_id(), "");
}

TEST_F(EnsembleClientTest, ARepeatedCancelSendsTheSameRequestId) {
  const EnsembleClient client = StartServer();
  const std::string id = "123e4567-e89b-12d3-a456-426614174000";
  ASSERT_OK(client.Cancel("ensembleJobs/a", id));
  client.Cancel("ensembleJobs/a", id).status().IgnoreError();
  const auto asked = server_.ensemble.Asked().cancel;
  ASSERT_EQ(asked.size(), 2u);
  EXPECT_EQ(asked[0].request_id(), id);
  EXPECT_EQ(asked[1].request_id(), id);
}

// By default a gRPC server accepts messages of up to 4 MiB.
TEST_F(EnsembleClientTest, ErrorOfATooLargeSpecificationHasPlainWords) {
  v1::EnsembleSpec spec;
  spec.mutable_grid()->mutable_rho()->Resize(1'000'000, 0.53);
  EXPECT_THAT(StartServer().Create(spec),
              StatusIs(absl::StatusCode::kResourceExhausted,
                       AllOf(StartsWith("the request or its answer is too large to be sent: 80000"),
                             HasSubstr(" bytes; at most 4194304 are permitted"))));
}

}  // namespace
}  // namespace ballpiston::client
