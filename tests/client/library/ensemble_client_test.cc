#include "client/library/ensemble_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "client/library/error_text.h"
#include "client/library/request_id.h"
#include "tests/client/fake_server.h"

namespace ballpiston::client {
namespace {

v1::EnsembleJob Named(const std::string& name) {
  v1::EnsembleJob job;
  job.set_name(name);
  return job;
}

TEST(RequestId, IsARandomUuid) {
  constexpr char kUuid[] = "[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}";
  std::set<std::string> ids;
  for (int i = 0; i < 1000; ++i) {
    ids.insert(NewRequestId());
    EXPECT_THAT(NewRequestId(), ::testing::MatchesRegex(kUuid));
  }
  EXPECT_EQ(ids.size(), 1000u);
}

// The channel repeats the call; the server can tell that it is the same one.
TEST(EnsembleClient, CreateIsRepeatedWithTheSameRequestId) {
  FakeServer server;
  server.ensemble.jobs = {Named("ensembleJobs/a")};
  server.ensemble.unavailable_attempts = 2;
  server.Start();
  v1::EnsembleSpec spec;
  spec.set_seed(7);
  const auto job = EnsembleClient(server.Channel()).Create(spec);
  ASSERT_TRUE(job.ok()) << job.status();
  EXPECT_EQ(job->name(), "ensembleJobs/a");
  const auto requests = server.ensemble.Asked().create;
  ASSERT_EQ(requests.size(), 3u);
  EXPECT_EQ(requests[0].request_id(), requests[2].request_id());
  EXPECT_EQ(requests[2].spec().seed(), 7u);
}

TEST(EnsembleClient, EachCreateHasAnIdOfItsOwn) {
  FakeServer server;
  server.ensemble.jobs = {Named("ensembleJobs/a")};
  server.Start();
  const EnsembleClient client(server.Channel());
  ASSERT_TRUE(client.Create(v1::EnsembleSpec()).ok());
  ASSERT_TRUE(client.Create(v1::EnsembleSpec()).ok());
  EXPECT_NE(server.ensemble.Asked().create[0].request_id(),
            server.ensemble.Asked().create[1].request_id());
}

TEST(EnsembleClient, CreateCarriesItsOptions) {
  FakeServer server;
  server.ensemble.jobs = {Named("ensembleJobs/a")};
  server.Start();
  const EnsembleClient client(server.Channel());
  ASSERT_TRUE(client.Create(v1::EnsembleSpec()).ok());
  ASSERT_TRUE(
      client.Create(v1::EnsembleSpec(), {.request_id = "id", .fresh = true, .priority = -7}).ok());
  const auto asked = server.ensemble.Asked().create;
  EXPECT_FALSE(asked[0].fresh());
  EXPECT_EQ(asked[0].priority(), 0);
  EXPECT_EQ(asked[1].request_id(), "id");
  EXPECT_TRUE(asked[1].fresh());
  EXPECT_EQ(asked[1].priority(), -7);
}

TEST(EnsembleClient, ListGathersAllPages) {
  FakeServer server;
  for (int i = 0; i < 5; ++i) server.ensemble.jobs.push_back(Named(std::to_string(i)));
  server.Start();
  const auto jobs = EnsembleClient(server.Channel()).List();
  ASSERT_TRUE(jobs.ok()) << jobs.status();
  ASSERT_EQ(jobs->size(), 5u);
  for (size_t i = 0; i < 5; ++i) EXPECT_EQ((*jobs)[i].name(), std::to_string(i));
}

TEST(EnsembleClient, ResultsGathersAllPagesOfTheViewAskedFor) {
  FakeServer server;
  for (int i = 0; i < 5; ++i) server.ensemble.points.emplace_back().set_index(i);
  server.Start();
  const auto points =
      EnsembleClient(server.Channel()).Results("ensembleJobs/a", v1::ListResultsRequest::BASIC);
  ASSERT_TRUE(points.ok()) << points.status();
  ASSERT_EQ(points->size(), 5u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ((*points)[static_cast<size_t>(i)].index(), i);
  ASSERT_EQ(server.ensemble.Asked().results.size(), 3u);
  const auto asked = server.ensemble.Asked();
  for (const auto& request : asked.results) {
    EXPECT_EQ(request.parent(), "ensembleJobs/a");
    EXPECT_EQ(request.view(), v1::ListResultsRequest::BASIC);
  }
}

TEST(EnsembleClient, ErrorsKeepCodeAndReason) {
  FakeServer server;
  server.Start();
  const auto job = EnsembleClient(server.Channel()).Get("ensembleJobs/none");
  EXPECT_EQ(job.status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(job.status().message(), "no such job: ensembleJobs/none (JOB_NOT_FOUND)");
  EXPECT_EQ(ErrorReason(job.status()), "JOB_NOT_FOUND");
}

TEST(EnsembleClient, WithoutAServerIsUnavailable) {
  const FakeServer server;  // not started
  const EnsembleClient client(server.Channel());
  EXPECT_EQ(client.List().status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(client.Delete("ensembleJobs/a").code(), absl::StatusCode::kUnavailable);
}

TEST(EnsembleClient, CancelCarriesARequestId) {
  FakeServer server;
  server.Start();
  ASSERT_TRUE(EnsembleClient(server.Channel()).Cancel("ensembleJobs/a").ok());
  ASSERT_EQ(server.ensemble.Asked().cancel.size(), 1u);
  EXPECT_EQ(server.ensemble.Asked().cancel[0].name(), "ensembleJobs/a");
  EXPECT_FALSE(server.ensemble.Asked().cancel[0].request_id().empty());
}

TEST(EnsembleClient, ACancelThatIsAskedAgainCarriesTheSameId) {
  FakeServer server;
  server.Start();
  const EnsembleClient client(server.Channel());
  const std::string id = "123e4567-e89b-12d3-a456-426614174000";
  ASSERT_TRUE(client.Cancel("ensembleJobs/a", id).ok());
  client.Cancel("ensembleJobs/a", id).status().IgnoreError();
  const auto asked = server.ensemble.Asked().cancel;
  ASSERT_EQ(asked.size(), 2u);
  EXPECT_EQ(asked[0].request_id(), id);
  EXPECT_EQ(asked[1].request_id(), id);
}

// The words are gRPC's own; a server takes 4 MiB if nobody tells it otherwise.
TEST(EnsembleClient, ASpecificationThatIsTooLargeIsToldInPlainWords) {
  FakeServer server;
  server.Start();
  v1::EnsembleSpec spec;
  spec.mutable_grid()->mutable_rho()->Resize(1'000'000, 0.53);
  const absl::Status status = EnsembleClient(server.Channel()).Create(spec).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(status.message().find("the request or its answer is too large to be sent: 80000"), 0u)
      << status;
  EXPECT_NE(status.message().find(" bytes; at most 4194304 are permitted"), std::string::npos);
}

}  // namespace
}  // namespace ballpiston::client
