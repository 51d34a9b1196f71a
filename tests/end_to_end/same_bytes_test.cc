// The same question gives the same bytes: whatever the number of workers, and through kill -9.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

// Four points of 16 blocks or more each.
std::vector<std::string> Question(int samples) {
  return {"first-hit",
          "--rho",
          "0.529561127988977",
          "--delta",
          "0.1,0.05",
          "--epsilon",
          "0.1,0.4",
          "--exponent",
          "1",
          "--samples",
          std::to_string(samples),
          "--seed",
          "11"};
}

constexpr int kPoints = 4;
// Some seconds of one core.
constexpr int kSamples = 300'000;

std::string Points(const TestServer& server, const std::string& job) {
  const ProcessResult result = server.Client({"result", job, "--format", "json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return PointsOf(result.out);
}

std::string PointsWithWorkers(int workers, int samples = kSamples) {
  const TestServer server(workers);
  const std::string job = server.Submit(Question(samples));
  EXPECT_EQ(server.Client({"watch", job}).exit_code, 0);
  return Points(server, job);
}

TEST(SameBytes, WithOneTwoAndEightWorkers) {
  const std::string one = PointsWithWorkers(1);
  EXPECT_EQ(At(ParseJson("{" + one), "points").list_value().values_size(), kPoints);
  EXPECT_EQ(PointsWithWorkers(2), one);
  EXPECT_EQ(PointsWithWorkers(8), one);
}

// The new experiments, each by every model that samples.
TEST(SameBytes, OfRelaxationAndMarkovPropertyWithOneAndTwoWorkers) {
  const std::vector<std::vector<std::string>> questions = {
      {"energy-relaxation", "--samples", "2000", "--delta", "0.2,0.1"},
      {"energy-relaxation", "--samples", "500", "--delta", "0.2", "--epsilon", "0.05,0.4"},
      {"energy-relaxation", "--samples", "4000", "--delta", "0.1", "--model", "markov"},
      {"energy-relaxation", "--tolerance", "0.1", "--delta", "0.1", "--model", "markov"},
      {"markov-property", "--collisions", "20000", "--delta", "0.2"},
      {"markov-property", "--collisions", "20000", "--delta", "0.2", "--model", "markov"}};
  const TestServer one(1), two(2);
  for (std::vector<std::string> question : questions) {
    question.insert(question.begin(), "run");
    question.insert(question.end(), {"--rho", "0.5296", "--seed", "3", "--format", "json"});
    const ProcessResult by_one = one.Client(question);
    ASSERT_EQ(by_one.exit_code, 0) << by_one.err;
    EXPECT_EQ(PointsOf(two.Client(question).out), PointsOf(by_one.out)) << question[1];
  }
}

bool HasSucceeded(const TestServer& server, const std::string& job) {
  const auto list = ParseJson(server.Client({"list", "--format", "json"}).out);
  const auto newest = At(list, "jobs", 0);
  EXPECT_EQ(At(newest, "name").string_value(), job);
  return At(newest, "state").string_value() == "SUCCEEDED";
}

// Kills the server when the client that watches tells that so many points are finished, or a moment
// later, and starts it again. False: the job had ended before.
bool KillInTheMidst(TestServer& server, const std::string& job, Process& watch, int finished) {
  const auto points_done = [](const std::string& line) {
    return static_cast<int>(At(ParseJson(line), "progress", "points_done").number_value());
  };
  const std::string line =
      watch.WaitForErrLine([&](const std::string& text) { return points_done(text) >= finished; });
  EXPECT_NE(line, "");
  server.KillHard();
  server.Start();
  return points_done(line) < kPoints && !HasSucceeded(server, job);
}

// Killed when a point is finished and others are not, and again when another one is. The client
// that watches stays, and attaches again by itself. Where the machine is so busy that a kill came
// when all was done, a larger question gives it more time.
TEST(SameBytes, ThroughKillNineAndRestart) {
  for (int samples = kSamples; samples <= 8 * kSamples; samples *= 2) {
    TestServer server(1);
    const std::string job = server.Submit(Question(samples));
    const auto watch = server.StartClient({"watch", job, "--progress", "json"});
    const bool first = KillInTheMidst(server, job, *watch, 1);
    const bool second = KillInTheMidst(server, job, *watch, 2);
    const ProcessResult watched = watch->Wait();
    ASSERT_EQ(watched.exit_code, 0) << watched.err;
    ASSERT_EQ(Points(server, job), PointsWithWorkers(2, samples));
    if (first && second) return;
  }
  FAIL() << "always killed too late";
}

// The neighbour that shows that these tests can fail.
TEST(SameBytes, AnotherSeedGivesOtherBytes) {
  const TestServer server;
  std::string points[2];
  for (const int seed : {0, 1}) {
    const std::string job =
        server.Submit({"equilibrium", "--rho", "0.53", "--delta", "0.2", "--collisions", "1000",
                       "--verify", "--seed", std::to_string(seed)});
    EXPECT_EQ(server.Client({"watch", job}).exit_code, 0);
    points[seed] = Points(server, job);
  }
  EXPECT_NE(points[0], points[1]);
}

}  // namespace
}  // namespace ballpiston
