#include "server/rpc/request_check.h"
#include "tests/server/preamble.h"
#include "tests/server/secure_server.h"

namespace ballpiston::server {
namespace {

// The number of finished points that a watch with this token gets.
int FinishedIn(const TestClient& server, const std::string& job, const std::string& token) {
  int points = 0;
  for (const WatchMessage& message : WatchStream(server, job, token).ToTheEnd()) {
    points += message.snapshot().finished_points_size();
  }
  return points;
}

class WatchTest : public testing::Test {
 protected:
  // Fake experiments; blocks from `held_from` on wait at the gate.
  RunningServer& Start(uint64_t held_from = std::numeric_limits<uint64_t>::max(),
                       std::chrono::milliseconds heartbeat = WatchTiming().heartbeat) {
    server_.reset();  // first: one at a time
    return server_.emplace(TestServerOptions{.data_dir = folder_.path(),
                                             .factory = GatedExperiments(gate_, held_from),
                                             .watch = {std::chrono::milliseconds(2), heartbeat}});
  }

  Gate gate_;
  TemporaryFolder folder_;
  std::optional<RunningServer> server_;
};

// ---- resume tokens ----

TEST_F(WatchTest, WithoutAValidTokenAllIsSent) {
  RunningServer& server = Start();
  const std::string name = server.Succeeded(Equilibrium(3, 1));
  const auto sent = [&](const std::string& token) { return FinishedIn(server, name, token); };
  storage::ResumeToken valid =
      *ParseToken<storage::ResumeToken>(WatchStream(server, name).ToTheEnd().back().resume_token());
  valid.set_finished(1);
  ASSERT_EQ(sent(TokenText(valid)), 2);

  std::vector<storage::ResumeToken> invalid(5, valid);
  invalid[0].set_job("another");
  invalid[1].set_restarts(1);
  invalid[2].set_restarts(-1);
  invalid[3].set_finished(4);  // the job has three points
  invalid[4].set_finished(-1);
  for (const storage::ResumeToken& token : invalid) {
    EXPECT_EQ(sent(TokenText(token)), 3) << token.ShortDebugString();
  }
  for (const std::string& text : {std::string("nonsense"), std::string("%"),
                                  std::string(10'000, 'A'), TokenText(valid).substr(1)}) {
    EXPECT_EQ(sent(text), 3) << text;
  }
}

// Also if this engine computed the job at first, and another engine later.
TEST_F(WatchTest, AfterARestartForAnotherEngineAllIsSentAgain) {
  const std::string name = Start().Succeeded(Equilibrium(3, 1));
  const std::string token = WatchStream(*server_, name).ToTheEnd().back().resume_token();
  server_.reset();
  ChangeJob(folder_.File("store.sqlite3"), name, [](EnsembleJob& job) {
    job.set_state(EnsembleJob::RUNNING);
    job.set_engine_version("0.0.1");
  });
  EXPECT_EQ(FinishedIn(Start(), name, token), 3);
}

TEST_F(WatchTest, WithATokenOnlyNewerStateIsSent) {
  RunningServer& server = Start(7, std::chrono::milliseconds(20));
  const std::string name = server.Submit(Equilibrium(1, 100));
  gate_.AwaitWaiting(2);  // seven blocks are done; the others wait
  WatchStream stream(server, name);
  std::optional<WatchMessage> message;
  do {
    ASSERT_TRUE(message = stream.Next());
  } while (message->snapshot().points().empty() ||
           message->snapshot().points(0).samples() != 7 * kFakeSamplesPerBlock);
  WatchStream again(server, name, message->resume_token());
  EXPECT_TRUE(again.Next()->has_job());
  do {
    ASSERT_TRUE(message = again.Next());
    EXPECT_TRUE(message->snapshot().points().empty());
  } while (!message->has_heartbeat());
}

// ---- messages ----

TEST_F(WatchTest, TheJobHasNoGridAndAnEndedJobHasAnExpiryTime) {
  RunningServer server({.factory = GatedExperiments(gate_), .limits = {.retain_days = 3}});
  WatchStream stream(server, server.Submit(Equilibrium(3, 1)));
  const EnsembleJob first = stream.Next().value().job();
  EXPECT_FALSE(first.has_expire_time());
  gate_.Open();
  const EnsembleJob last = stream.ToTheEnd().back().job();
  const EnsembleJob later = WatchStream(server, last.name()).ToTheEnd().back().job();
  for (const EnsembleJob& job : {first, last, later}) {
    EXPECT_FALSE(job.spec().has_grid());
    EXPECT_EQ(job.spec().experiment(), v1::EnsembleSpec::EQUILIBRIUM);
    EXPECT_EQ(job.progress().points(), 3);
  }
  for (const EnsembleJob& job : {last, later}) {
    EXPECT_EQ(job.expire_time().seconds() - job.end_time().seconds(), 3 * 86400);
  }
}

// ---- a watch or a trace ends when the credentials of its call become invalid ----

class WatchCredentialsTest : public testing::Test {
 protected:
  TestClient ClientWith(const char* token) const {
    return TestClient(server_.NewChannel(files_.Credentials(token)));
  }

  void ReplaceAccess(const std::string& lines) {
    files_.WriteAccessFile(lines);
    ASSERT_OK(server_.server().Reload());
  }

  Gate gate_;
  LaboratoryFiles files_;
  RunningServer server_{Secure(files_, {.factory = GatedExperiments(gate_),
                                        .watch = {.heartbeat = std::chrono::milliseconds(20)}})};
  TestClient alice_ = ClientWith(kAlice);
  TestClient ops_ = ClientWith(kOps);
};

TEST_F(WatchCredentialsTest, AWatchEndsWhenItsTokenIsNoLongerValid) {
  const absl::Time past = absl::FromUnixSeconds(1'000'000'000);
  const std::string ops = TokenLine(kOps, {"ops", Role::kAdmin});
  const struct {
    const char* token;
    std::string access_file;
    const char* reason;
  } rows[] = {
      {kAlice, ops, "CREDENTIALS_INVALID"},  // revoked
      {kAlice, TokenLine(kAlice, {"alice", Role::kSubmit}, past), "CREDENTIALS_EXPIRED"},
      {kAlice, TokenLine(kAlice, {"bob", Role::kAdmin}), "CREDENTIALS_INVALID"},
      {kOps, TokenLine(kOps, {"ops", Role::kSubmit}), "JOB_NOT_FOUND"}};  // of another's job
  const std::string job = alice_.Submit(Equilibrium(1, 2));               // waits at the gate
  for (const auto& [token, access_file, reason] : rows) {
    ReplaceAccess(LaboratoryTokens());
    TestClient client = ClientWith(token);
    WatchStream watch(client, job);
    for (int beats = 0; beats < 3;) beats += watch.Next().value().has_heartbeat();  // valid so far
    ReplaceAccess(access_file);
    EXPECT_EQ(ReasonOf(watch.End()), reason) << access_file;
  }
}

// The trace has far more events than gRPC keeps of a stream whose reader stalls.
TEST_F(WatchCredentialsTest, ATraceEndsWhenItsTokenIsRevoked) {
  TraceStream trace(alice_,
                    FromText<v1::TraceOrbitRequest>("rho: 0.53 delta: 0.15 events: 1000000"));
  ASSERT_TRUE(trace.Next());
  ReplaceAccess(TokenLine(kOps, {"ops", Role::kAdmin}));
  EXPECT_THAT(trace.End(), Not(IsOk()));  // CANCELLED if the reader was slow
}

TEST_F(WatchCredentialsTest, AStalledReaderLosesItsWatchToo) {
  gate_.Open();
  const std::string name = alice_.Succeeded(Equilibrium(20'000, 1));  // some MB of points
  TestClient slow(OwnChannel(server_.address(), files_.Credentials(kAlice), SmallWindow()));
  WatchStream stalled(slow, name);
  AwaitThat([this] { return ops_.Status().streams() == 1; });  // the server has the watch
  ReplaceAccess(TokenLine(kOps, {"ops", Role::kAdmin}));
  AwaitThat([this] { return ops_.Status().streams() == 0; });
  EXPECT_THAT(stalled.End(), Not(IsOk()));
}

}  // namespace
}  // namespace ballpiston::server
