// Single calls, their request ids and their errors.
#include "client/library/client.h"
#include "client/library/error_text.h"
#include "client/library/request_id.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// ---- client.h ----

class ClientTest : public ::testing::Test {
 protected:
  ClientTest() { server_.jobs = {JobIn(v1::EnsembleJob::QUEUED)}; }

  Client StartServer() {
    server_.Start();
    return Client(server_.Channel(), absl::FromChrono(kPatience));
  }

  FakeServer server_;
};

TEST_F(ClientTest, ResultsGathersAllPagesInTheRequestedView) {
  for (int i = 0; i < 5; ++i) server_.points.emplace_back().set_index(i);
  ASSERT_OK_AND_ASSIGN(const auto points,
                       StartServer().Results(kJobName, v1::ListResultsRequest::BASIC));
  ASSERT_EQ(points.size(), 5u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(points[static_cast<size_t>(i)].index(), i);
  const auto asked = server_.Asked<v1::ListResultsRequest>();
  ASSERT_EQ(asked.size(), 3u);
  for (const auto& request : asked) {
    EXPECT_EQ(request.parent(), kJobName);
    EXPECT_EQ(request.view(), v1::ListResultsRequest::BASIC);
  }
}

TEST_F(ClientTest, LargeAnswersAreReceived) {
  server_.status.set_version(std::string(5 << 20, 'v'));
  ASSERT_OK_AND_ASSIGN(const v1::ServerStatus status, StartServer().Status());
  EXPECT_EQ(status.version().size(), size_t{5 << 20});
  EXPECT_THAT(server_.Asked<v1::GetServerStatusRequest>(), SizeIs(1));
}

TEST_F(ClientTest, ListStopsAtItsLimit) {
  server_.jobs.assign(5, JobIn(v1::EnsembleJob::QUEUED));
  const Client client = StartServer();
  v1::ListEnsembleJobsRequest request;
  request.set_page_token("4");  // has no effect
  ASSERT_OK_AND_ASSIGN(const auto jobs, client.List(request, 3));
  EXPECT_EQ(jobs.size(), 3u);
  const auto asked = server_.Asked<v1::ListEnsembleJobsRequest>();
  ASSERT_EQ(asked.size(), 2u);  // pages of two
  EXPECT_EQ(asked[1].page_size(), 1);
  EXPECT_OK(client.List(request, 0));
  EXPECT_THAT(server_.Asked<v1::ListEnsembleJobsRequest>(), SizeIs(2));
}

// Without the server's wish the three attempts would take 0.4 s at most.
TEST_F(ClientTest, APinIsRepeatedAfterThePausesThatTheServerAsksFor) {
  server_.unavailable_attempts = 2;
  const Client client = StartServer();
  const absl::Time begin = absl::Now();
  EXPECT_OK(client.Pin(kJobName, true));
  EXPECT_GE(absl::Now() - begin, absl::Milliseconds(790));
}

TEST_F(ClientTest, ACallbackEndsATrace) {
  server_.orbit.resize(100'000);
  int messages = 0;
  EXPECT_OK(StartServer().Trace({}, [&](const v1::TraceOrbitResponse&) { return ++messages < 3; }));
  EXPECT_EQ(messages, 3);
}

// The messages that it has read would come twice.
TEST_F(ClientTest, AStreamIsNotRepeatedAfterItsFirstMessage) {
  server_.orbit.resize(1);
  server_.trace_end = grpc::Status(grpc::StatusCode::UNAVAILABLE, "stops");
  server_.Start();
  int revivals = 0, messages = 0;
  const Client client(server_.Channel(), absl::FromChrono(kPatience), [&revivals] {
    ++revivals;
    return absl::OkStatus();
  });
  const auto read = [&messages](const v1::TraceOrbitResponse&) { return ++messages > 0; };
  EXPECT_THAT(client.Trace({}, read), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_EQ(messages, 1);
  EXPECT_EQ(revivals, 0);
}

// ---- request_id.h ----

auto IsUuid(int version) {
  return MatchesRegex(absl::StrCat("[0-9a-f]{8}-[0-9a-f]{4}-", version,
                                   "[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}"));
}

TEST(RequestId, RandomIdsAndThoseOfTextsAreUuids) {
  std::set<std::string> random, of_texts;
  for (int i = 0; i < 1000; ++i) {
    random.insert(NewRequestId());
    of_texts.insert(RequestIdFor(absl::StrCat("question ", i)));
  }
  EXPECT_THAT(random, AllOf(SizeIs(1000), Each(IsUuid(4))));
  EXPECT_THAT(of_texts, AllOf(SizeIs(1000), Each(IsUuid(8))));
}

// A later version of the program must make the same ids.
TEST(RequestId, OfATextIsStable) {
  EXPECT_EQ(RequestIdFor(""), "cbf29ce4-8422-8325-9e37-79b97f4a7c15");
  EXPECT_EQ(RequestIdFor("question 0"), "f158c797-54ff-80dd-b8d7-5edcd5c77fad");
}

// ---- error_text.h ----

// transcripts/refusals.txt shows messages, their reasons and their details.
TEST(ErrorText, MalformedDetailsDoNotHideTheMessage) {
  EXPECT_EQ(FromGrpc(grpc::Status(grpc::StatusCode::INTERNAL, "went wrong", "\xff\xff\xff")),
            absl::InternalError("went wrong"));
}

}  // namespace
}  // namespace ballpiston::client
