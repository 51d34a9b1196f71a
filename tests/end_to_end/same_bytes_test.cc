// The same question gives the same bytes: whatever the number of workers, and through kill -9.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <string>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

// Four points of 32 blocks or more each.
const Words kQuestion = Split(
    "first-hit --rho 0.529561127988977 --delta 0.2,0.1 --epsilon 0.1,0.4 --exponent 1 --seed 11 "
    "--samples 300000");
constexpr int kPoints = 4;

std::string Points(const TestServer& server, const std::string& job) {
  const ProcessResult result = server.Client({"result", job, "--format", "json"});
  EXPECT_THAT(result, ExitsWith(0));
  return PointsOf(result.out);
}

std::string PointsWithWorkers(int workers) {
  const TestServer server(workers);
  const std::string job = server.Submit(kQuestion);
  EXPECT_THAT(server.Client({"watch", job}), ExitsWith(0));
  return Points(server, job);
}

TEST(SameBytes, WithOneTwoAndEightWorkers) {
  const std::string one = PointsWithWorkers(1);
  EXPECT_EQ(Length(At(ParseJson("{" + one), "points")), kPoints);
  EXPECT_EQ(PointsWithWorkers(2), one);
  EXPECT_EQ(PointsWithWorkers(8), one);
}

// By every model that samples.
TEST(SameBytes, OfRelaxationMarkovPropertyAndGasesWithOneAndTwoWorkers) {
  const TestServer one(1), two(2);
  for (const std::string question :
       {"energy-relaxation --samples 500 --delta 0.2,0.1",
        "energy-relaxation --samples 200 --delta 0.2 --epsilon 0.05,0.4",
        "energy-relaxation --samples 2000 --delta 0.1 --model markov",
        "energy-relaxation --tolerance 0.1 --delta 0.1 --model markov",
        "markov-property --collisions 20000 --delta 0.2",
        "markov-property --collisions 20000 --delta 0.2 --model markov",
        "lyapunov --collisions 20000 --delta 0.2",
        "gas-lyapunov --samples 64 --delta 0.19 --cells 2,2x2",
        "gas-equilibrium --verify --samples 96 --delta 0.19 --cells 3,2x2 --temperature 1",
        "gas-equilibrium --model markov --samples 200 --delta 0.19 --cells 3 --temperature 1",
        "gas-conduction --samples 600 --delta 0.19,0.17 --cells 2 --hot 1.5 --cold 0.5",
        "gas-conduction --samples 600 --delta 0.19 --cells 2x2 --hot 2 --cold 1 --model markov"}) {
    const Words words = Split("run " + question + " --rho 0.5296 --seed 3 --format json");
    const ProcessResult by_one = one.Client(words);
    ASSERT_THAT(by_one, ExitsWith(0));
    EXPECT_EQ(PointsOf(two.Client(words).out), PointsOf(by_one.out)) << question;
  }
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
  EXPECT_EQ(Points(server, job), PointsWithWorkers(2));
}

// The comparison of the tests above can fail.
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
