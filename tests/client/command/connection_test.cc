// The server that a verb uses, and the errors if it does not answer.
#include "client/command/connection.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// The channel makes up to this number of attempts for a call, but only one for a delete.
constexpr int kChannelAttempts = 4;

class ConnectionTest : public ProgramTest {
 protected:
  void StartPrivateServer(int unavailable_attempts = 0) {
    home_.UseAsPrivateServer(server_.Address());
    server_.unavailable_attempts = unavailable_attempts;
    server_.Start();
  }
};

TEST_F(ConnectionTest, ARetryToAPrivateServerHasTheSameRequestId) {
  StartPrivateServer(kChannelAttempts);
  const Outcome outcome = Ballpiston({"submit", "first-hit", "--rho", "0.53"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "ensembleJobs/abc\n");
  const auto asked = server_.Asked<v1::CreateEnsembleJobRequest>();
  ASSERT_EQ(std::ssize(asked), kChannelAttempts + 1);
  EXPECT_EQ(asked.front().request_id(), asked.back().request_id());
}

// With a new request id the second cancel would fail, because the job has ended.
TEST_F(ConnectionTest, ACancelIsRepeatedWithTheSameId) {
  StartPrivateServer(kChannelAttempts);
  const Outcome outcome = Ballpiston({"cancel", "abc"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(std::ssize(server_.Asked<v1::CancelEnsembleJobRequest>()), kChannelAttempts + 1);
}

// If the first answer was lost, a second delete would report that the job does not exist.
TEST_F(ConnectionTest, ADeleteIsNotRepeated) {
  StartPrivateServer(1);
  const Outcome outcome = Ballpiston({"delete", "abc"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, StartsWith("ballpiston: ensembleJobs/abc may have been deleted\n"
                                      "ballpiston: no answer from the server at "));
  EXPECT_EQ(server_.Asked<v1::DeleteEnsembleJobRequest>().size(), 1u);
}

TEST_F(ConnectionTest, APrivateServerGetsAtMostTwoAttempts) {
  StartPrivateServer(100);
  EXPECT_EQ(Ballpiston({"submit", "first-hit"}).code, 3);
  EXPECT_EQ(std::ssize(server_.Asked<v1::CreateEnsembleJobRequest>()), 2 * kChannelAttempts);
}

TEST_F(ConnectionTest, ANamedServerGetsOneAttempt) {
  server_.unavailable_attempts = kChannelAttempts;
  server_.Start();
  EXPECT_EQ(WithServer({"submit", "first-hit"}).code, 3);
  EXPECT_EQ(std::ssize(server_.Asked<v1::CreateEnsembleJobRequest>()), kChannelAttempts);
}

// For instance because a token expired.
TEST_F(ConnectionTest, AnErrorOfAWatchShowsHowToWatchTheJobAgain) {
  server_.watches = {{{}, grpc::Status(grpc::StatusCode::UNAUTHENTICATED, "expired")}};
  for (const char* verb : {"watch abc", "run first-hit"}) {
    const Outcome outcome = WithServer(absl::StrSplit(verb, ' '));
    EXPECT_EQ(outcome.code, 6);
    EXPECT_THAT(outcome.err, StartsWith("The job continues.\n  watch it again:  ballpiston watch "
                                        "ensembleJobs/abc --server "));
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr(server_.Address()), EndsWith("\nballpiston: expired\n")));
  }
}

// Five points on three pages; the first attempts to list the second page fail.
TEST_F(ConnectionTest, OnlyAPrivateServerIsAskedForAPageAgain) {
  for (int i = 1; i < 5; ++i) server_.points.emplace_back().set_index(i);
  server_.unavailable_later_pages = 2 * kChannelAttempts;
  StartPrivateServer();
  const std::vector<std::string> words = {"result", "abc", "--format", "jsonl"};
  EXPECT_EQ(WithServer(words).code, 3);
  const Outcome outcome = Ballpiston(words);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<std::string> points = absl::StrSplit(outcome.out, '\n', absl::SkipEmpty());
  ASSERT_EQ(points.size(), 5u) << outcome.out;  // each point once
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_THAT(points[i], StartsWith(absl::StrCat("{\"index\":", i)));
  }
}

// The errors of Unix sockets that other users may not open, and of connections without TLS.
TEST(ConnectionHint, FollowsFromTheErrorAndTheKindOfAddress) {
  const std::string socket = "unix:/run/s";
  const std::tuple<std::string, std::string, std::string> table[] = {
      {socket, "last error: UNAVAILABLE: unix:/run/s: Socket closed", "only its own user"},
      {socket, "last error: UNKNOWN: unix:/run/s: Permission denied", "only its own user"},
      {"host:1", "recvmsg:Connection reset by peer", "--ca FILE, or --tls"}};
  for (const auto& [address, error, hint] : table) {
    EXPECT_THAT(ConnectionHint(address, {}, error), HasSubstr(hint));
  }
  EXPECT_EQ(ConnectionHint(socket, {}, "unix:/run/s: No such file or directory"), "");
  EXPECT_EQ(ConnectionHint("host:1", {}, "Connection refused"), "");
}

}  // namespace
}  // namespace ballpiston::client
