// A watch or a trace ends when the credentials of its call become invalid.
#include "tests/server/preamble.h"
#include "tests/server/rpc/message_stream.h"
#include "tests/server/secure_server.h"

namespace ballpiston::server {
namespace {

class WatchCredentialsTest : public testing::Test {
 protected:
  TestClient ClientWith(const char* token) const {
    return TestClient(server_.NewChannel(files_.Credentials(token)));
  }

  // Submits a job of alice that waits at the gate; returns its name.
  std::string JobOfAlice() { return alice_.Submit(Equilibrium(1, 2)); }

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
  const std::string job = JobOfAlice();
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
  WatchStream watch(alice_, JobOfAlice());
  ReplaceAccess(LaboratoryTokens());
  int beats = 0;
  while (beats < 3) {
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
