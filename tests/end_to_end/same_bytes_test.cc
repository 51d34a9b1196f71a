// The same question gives the same bytes: whatever the number of workers, and through kill -9.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

// Four points of 32 blocks or more each.
Words Question(int samples) {
  return Split(
      "first-hit --rho 0.529561127988977 --delta 0.1,0.05 --epsilon 0.1,0.4 --exponent 1 "
      "--seed 11 --samples " +
      std::to_string(samples));
}

constexpr int kPoints = 4;
// Some seconds of one core.
constexpr int kSamples = 300'000;

std::string Points(const TestServer& server, const std::string& job) {
  const ProcessResult result = server.Client({"result", job, "--format", "json"});
  EXPECT_THAT(result, ExitsWith(0));
  return PointsOf(result.out);
}

std::string PointsWithWorkers(int workers, int samples = kSamples) {
  const TestServer server(workers);
  const std::string job = server.Submit(Question(samples));
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
       {"energy-relaxation --samples 2000 --delta 0.2,0.1",
        "energy-relaxation --samples 500 --delta 0.2 --epsilon 0.05,0.4",
        "energy-relaxation --samples 4000 --delta 0.1 --model markov",
        "energy-relaxation --tolerance 0.1 --delta 0.1 --model markov",
        "markov-property --collisions 20000 --delta 0.2",
        "markov-property --collisions 20000 --delta 0.2 --model markov",
        "gas-equilibrium --verify --samples 300 --delta 0.19 --cells 4,2x3 --temperature 1",
        "gas-equilibrium --model markov --samples 300 --delta 0.19 --cells 4 --temperature 1",
        "gas-conduction --samples 200 --delta 0.19,0.1 --cells 3 --hot 1.5 --cold 0.5",
        "gas-conduction --samples 200 --delta 0.19 --cells 2x2 --hot 2 --cold 1 --model markov"}) {
    const Words words = Split("run " + question + " --rho 0.5296 --seed 3 --format json");
    const ProcessResult by_one = one.Client(words);
    ASSERT_THAT(by_one, ExitsWith(0));
    EXPECT_EQ(PointsOf(two.Client(words).out), PointsOf(by_one.out)) << question;
  }
}

bool HasSucceeded(const TestServer& server, const std::string& job) {
  const auto list = server.Json({"list"});
  const auto newest = At(list, "jobs", 0);
  EXPECT_EQ(At(newest, "name").string_value(), job);
  return At(newest, "state").string_value() == "SUCCEEDED";
}

// Waits until the watching client prints that `finished` points are finished, then kills the server
// and starts it again. False if the job had ended before the kill.
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

// The server is killed when one point is finished, and again when a second one is. The watching
// client reattaches itself. If the job ended before a kill, the next one has twice as many samples.
TEST(SameBytes, ThroughKillNineAndRestart) {
  for (int samples = kSamples; samples <= 8 * kSamples; samples *= 2) {
    TestServer server(1);
    const std::string job = server.Submit(Question(samples));
    const auto watch = server.StartClient({"watch", job, "--progress", "json"});
    const bool first = KillInTheMidst(server, job, *watch, 1);
    const bool second = KillInTheMidst(server, job, *watch, 2);
    const ProcessResult watched = watch->Wait();
    ASSERT_THAT(watched, ExitsWith(0));
    ASSERT_EQ(Points(server, job), PointsWithWorkers(2, samples));
    if (first && second) return;
  }
  FAIL() << "always killed too late";
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
