
#include "server/rpc/request_check.h"
#include "tests/server/preamble.h"
#include "tests/server/rpc/message_stream.h"
#include "tests/server/secure_server.h"

namespace ballpiston::server {
namespace {

// The finished points in the messages, in their order.
std::vector<int> FinishedIn(const std::vector<WatchMessage>& messages) {
  std::vector<int> points;
  for (const WatchMessage& message : messages) {
    EXPECT_LE(message.snapshot().finished_points_size(), 100);
    for (const auto& point : message.snapshot().finished_points()) points.push_back(point.index());
  }
  return points;
}

class WatchTest : public testing::Test {
 protected:
  // Fake experiments; blocks from `held_from` on wait at the gate.
  RunningServer& Start(uint64_t held_from = std::numeric_limits<uint64_t>::max(),
                       std::chrono::milliseconds heartbeat = WatchTiming().heartbeat) {
    return StartWith({.factory = GatedExperiments(gate_, held_from),
                      .watch = {std::chrono::milliseconds(2), heartbeat}});
  }

  RunningServer& StartWith(TestServerOptions options) {
    server_.reset();  // first: one at a time
    options.data_dir = folder_.path();
    server_.emplace(options);
    return *server_;
  }

  Gate gate_;
  TemporaryFolder folder_;
  std::optional<RunningServer> server_;
};

// ---- resume tokens ----

TEST_F(WatchTest, WithoutAValidTokenAllIsSent) {
  RunningServer& server = Start();
  const std::string name = server.Succeeded(Equilibrium(3, 1));
  const auto sent = [&](const std::string& token) {
    return FinishedIn(WatchStream(server, name, token).ToTheEnd()).size();
  };
  storage::ResumeToken valid =
      *ParseToken<storage::ResumeToken>(WatchStream(server, name).ToTheEnd().back().resume_token());
  valid.set_finished(1);
  ASSERT_EQ(sent(TokenText(valid)), 2u);

  std::vector<storage::ResumeToken> invalid(5, valid);
  invalid[0].set_job("another");
  invalid[1].set_restarts(1);
  invalid[2].set_restarts(-1);
  invalid[3].set_finished(4);  // the job has three points
  invalid[4].set_finished(-1);
  for (const storage::ResumeToken& token : invalid) {
    EXPECT_EQ(sent(TokenText(token)), 3u) << token.ShortDebugString();
  }
  for (const std::string& text : {std::string("nonsense"), std::string("%"),
                                  std::string(10'000, 'A'), TokenText(valid).substr(1)}) {
    EXPECT_EQ(sent(text), 3u) << text;
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
  EXPECT_EQ(FinishedIn(WatchStream(Start(), name, token).ToTheEnd()).size(), 3u);
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
  stream.Leave();
  WatchStream again(server, name, message->resume_token());
  EXPECT_TRUE(again.Next()->has_job());
  do {
    ASSERT_TRUE(message = again.Next());
    EXPECT_TRUE(message->snapshot().points().empty());
  } while (!message->has_heartbeat());
}

// ---- messages ----

// Both to a watch that began before the end, when the job was active, and to a later watch.
TEST_F(WatchTest, TheEndSaysWhenTheResultsExpire) {
  RunningServer& server =
      StartWith({.factory = GatedExperiments(gate_, 3), .limits = {.retain_days = 3}});
  const std::string name = server.Submit(Equilibrium(1, 5));
  WatchStream stream(server, name);
  EXPECT_FALSE(stream.Next()->job().has_expire_time());
  gate_.Open();
  for (const EnsembleJob& job :
       {stream.ToTheEnd().back().job(), WatchStream(server, name).ToTheEnd().back().job()}) {
    EXPECT_EQ(job.expire_time().seconds() - job.end_time().seconds(), 3 * 86400);
  }
}

TEST_F(WatchTest, TheJobHasNoGrid) {
  RunningServer& server = Start(0);
  const std::string name = server.Submit(LargeEquilibrium());
  WatchStream stream(server, name);
  const auto first = stream.Next();
  ASSERT_TRUE(first);
  EXPECT_FALSE(first->job().spec().has_grid());
  EXPECT_EQ(first->job().spec().experiment(), v1::EnsembleSpec::EQUILIBRIUM);
  EXPECT_EQ(first->job().progress().points(), 90'000);
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
    ASSERT_TRUE(watch.Next());
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

TEST_F(WatchCredentialsTest, AWatchWithAValidTokenGoesOn) {
  WatchStream watch(alice_, alice_.Submit(Equilibrium(1, 2)));
  ReplaceAccess(LaboratoryTokens());
  for (int beats = 0; beats < 3;) {
    const auto message = watch.Next();
    ASSERT_TRUE(message);
    beats += message->has_heartbeat();
  }
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
