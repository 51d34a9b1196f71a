// A watch ends when the credentials of its call become invalid.
#include <chrono>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/error_details.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/own_channel.h"
#include "tests/server/requests.h"
#include "tests/server/rpc/watch_stream.h"
#include "tests/server/running_server.h"
#include "tests/server/secure_server.h"
#include "tests/support/await.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::Not;

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

TEST_F(WatchCredentialsTest, AWatchEndsWhenItsTokenIsRevoked) {
  WatchStream watch(alice_, JobOfAlice());
  ASSERT_TRUE(watch.Next());
  ReplaceAccess(TokenLine(kOps, {"ops", Role::kAdmin}));
  EXPECT_THAT(watch.End(), IsError(grpc::StatusCode::UNAUTHENTICATED, "CREDENTIALS_INVALID"));
}

TEST_F(WatchCredentialsTest, AWatchEndsWhenItsTokenExpires) {
  WatchStream watch(alice_, JobOfAlice());
  ASSERT_TRUE(watch.Next());
  ReplaceAccess(TokenLine(kAlice, {"alice", Role::kSubmit}, absl::FromUnixSeconds(1'000'000'000)));
  EXPECT_THAT(watch.End(), IsError(grpc::StatusCode::UNAUTHENTICATED, "CREDENTIALS_EXPIRED"));
}

TEST_F(WatchCredentialsTest, AWatchEndsWhenItsTokenIsAnotherPrincipals) {
  WatchStream watch(alice_, JobOfAlice());
  ASSERT_TRUE(watch.Next());
  ReplaceAccess(TokenLine(kAlice, {"bob", Role::kAdmin}));
  EXPECT_EQ(ReasonOf(watch.End()), "CREDENTIALS_INVALID");
}

TEST_F(WatchCredentialsTest, AFormerAdministratorLosesTheWatchOfAnothersJob) {
  WatchStream watch(ops_, JobOfAlice());
  ASSERT_TRUE(watch.Next());
  ReplaceAccess(TokenLine(kOps, {"ops", Role::kSubmit}) +
                TokenLine(kAlice, {"alice", Role::kRead}));
  EXPECT_THAT(watch.End(), IsError(grpc::StatusCode::NOT_FOUND, "JOB_NOT_FOUND"));
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
