// The same question gives the same bytes through kill -9. tests/server/restart_test.cc tests
// that the number of workers changes nothing.
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

// Four points of 32 blocks or more each.
const Words kQuestion = Split(
    "first-hit --rho 0.529561127988977 --delta 0.2,0.1 --epsilon 0.1,0.4 --exponent 1 --seed 11 "
    "--samples 300000");

std::string Points(const TestServer& server, const std::string& job) {
  const ProcessResult result = server.Client({"result", job, "--format", "json"});
  EXPECT_THAT(result, ExitsWith(0));
  return PointsOf(result.out);
}

std::string UndisturbedPoints() {
  const TestServer server;
  const std::string job = server.Submit(kQuestion);
  EXPECT_THAT(server.Client({"watch", job}), ExitsWith(0));
  return Points(server, job);
}

// The server is killed when the result of the second point waits to be written, and again after the
// first result of its second life. The client that watches reattaches itself: an endless job of a
// higher priority keeps the worker busy until the client has printed its first line.
TEST(SameBytes, ThroughKillNineAndRestart) {
  TestServer server(1);
  server.KillHard();
  server.Spawn("point.recorded:2");
  ASSERT_TRUE(server.AwaitReady());
  const std::string earlier = server.Submit(Joined({kEndlessQuestion, {"--priority", "1"}}));
  const std::string job = server.Submit(kQuestion);
  const auto watch = server.StartClient({"watch", job, "--progress", "json"});
  EXPECT_TRUE(watch->WaitForErr("\n"));
  EXPECT_THAT(server.Client({"cancel", earlier}), ExitsWith(0));
  EXPECT_EQ(server.AwaitEnd(), 128 + SIGKILL);
  server.Spawn("point.recorded:1");
  EXPECT_EQ(server.AwaitEnd(), 128 + SIGKILL);
  server.Start();
  EXPECT_THAT(watch->Wait(), ExitsWith(0));
  EXPECT_EQ(Points(server, job), UndisturbedPoints());
}

// The comparison of the test above can fail.
TEST(SameBytes, AnotherSeedGivesOtherBytes) {
  const TestServer server;
  std::string points[2];
  for (const int seed : {0, 1}) {
    const std::string job = server.Submit(
        Split("equilibrium --rho 0.53 --delta 0.2 --collisions 1000 --verify --seed " +
              std::to_string(seed)));
    EXPECT_THAT(server.Client({"watch", job}), ExitsWith(0));
    points[seed] = Points(server, job);
  }
  EXPECT_NE(points[0], points[1]);
}

}  // namespace
}  // namespace ballpiston
