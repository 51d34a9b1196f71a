// The server is killed again and again, at random times and at every failpoint, under clients that
// ask for all it can do.
#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <chrono>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/library/ensemble_client.h"
#include "server/observability/failpoint.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/server_process.h"
#include "tests/fault/torture/sizes.h"
#include "tests/fault/torture/visitor.h"

namespace ballpiston::torture {
namespace {

constexpr int kVisitors = 6;
constexpr std::chrono::milliseconds kLongestLife(600);
// After it a failpoint that nobody came by is given up, and the server killed all the same.
constexpr std::chrono::milliseconds kWaitForFirstVisit(10'000), kWaitForFailpoint(1500);
constexpr int kKilled = 128 + SIGKILL;

// The commonest are passed at every block, the rarest once or twice in a server's life.
int MostPasses(std::string_view failpoint) {
  if (failpoint.starts_with("store.")) return 30;
  if (failpoint.starts_with("block.") || failpoint == "resume.block") return 20;
  return failpoint.starts_with("stop.") ? 1 : 3;
}

class Killer {
 public:
  Killer(ServerProcess& server, Findings& findings) : server_(server), findings_(findings) {}

  // One life in four is counted from the process's start, before the server is ready.
  void KillAtRandom() {
    server_.Spawn();
    if (Pick(0, 3) != 0) server_.AwaitReady();
    const std::chrono::milliseconds life(Pick(0, static_cast<int>(kLongestLife.count())));
    const auto early = server_.AwaitEnd(life);
    if (early) return findings_.Wrong(absl::StrCat("ended by itself: ", server_.log()));
    server_.KillHard();
    findings_.Count("kills at random");
  }

  // At its first pass the first time, later at any.
  void KillAt(std::string_view failpoint, bool first_visit) {
    const int pass = Pick(1, first_visit ? 1 : MostPasses(failpoint));
    server_.Spawn(absl::StrCat(std::string(failpoint), ":", pass));
    const bool stopping = failpoint.starts_with("stop.");
    if (stopping && server_.AwaitReady()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(Pick(0, 300)));
      server_.Signal(SIGTERM);
    }
    if (!stopping) server_.AwaitReady();
    const auto end =
        server_.AwaitEnd(first_visit || stopping ? kWaitForFirstVisit : kWaitForFailpoint);
    if (!end) server_.KillHard();
    findings_.Count("kills at " + std::string(end ? failpoint : "failpoints not come by"));
    if (end && *end != kKilled) {
      findings_.Wrong(absl::StrCat(std::string(failpoint), ": ended with ", *end));
    }
  }

 private:
  int Pick(int least, int most) { return std::uniform_int_distribution<int>(least, most)(random_); }

  ServerProcess& server_;
  Findings& findings_;
  std::mt19937_64 random_{20};
};

int64_t KillsAt(const Findings& findings, std::string_view failpoint) {
  return findings.count("kills at " + std::string(failpoint));
}

// Half of them at random, half at failpoints, in turn.
void KillManyTimes(int kills, ServerProcess& server, Findings& findings) {
  Killer killer(server, findings);
  for (int i = 0; i < kills; ++i) {
    if (i % 2 == 0) {
      killer.KillAtRandom();
    } else {
      const size_t turn = static_cast<size_t>(i) / 2;
      const std::string_view failpoint = server::kFailpoints[turn % server::kFailpoints.size()];
      killer.KillAt(failpoint, KillsAt(findings, failpoint) == 0);
    }
  }
}

std::set<std::string> NamesOn(ServerProcess& server) {
  const auto jobs = client::EnsembleClient(server.Connect()).List();
  EXPECT_TRUE(jobs.ok()) << jobs.status();
  std::set<std::string> names;
  for (const v1::EnsembleJob& job : *jobs) EXPECT_TRUE(names.insert(job.name()).second);
  return names;
}

TEST(Kills, LoseNothingThatWasAcknowledgedAndCountNothingTwice) {
  Findings findings("kills");
  Exam exam;
  exam.questions = Questions();
  exam.answers = UndisturbedAnswers(exam.questions);

  ServerProcess server;
  std::vector<Visitor> visitors;
  for (uint64_t seed = 0; seed < kVisitors; ++seed) {
    visitors.emplace_back(server.Connect(), exam, seed, findings);
  }
  std::atomic<bool> enough = false;
  std::vector<std::thread> threads;
  for (Visitor& visitor : visitors) {
    threads.emplace_back([&] { visitor.VisitUntil(enough); });
  }
  const auto start = std::chrono::steady_clock::now();
  KillManyTimes(Size(2 * static_cast<int>(server::kFailpoints.size()), 1000), server, findings);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  findings.Note("seconds of killing", absl::StrCat(took.count()));

  server.Start();
  enough = true;
  for (std::thread& thread : threads) thread.join();
  std::set<std::string> expected;
  for (Visitor& visitor : visitors) {
    visitor.CheckAll();
    expected.merge(visitor.names());
  }
  EXPECT_EQ(NamesOn(server), expected);  // none is lost, none is there twice, none is back
  for (const std::string_view failpoint : server::kFailpoints) {
    EXPECT_GT(KillsAt(findings, failpoint), 0) << failpoint << " was not come by";
  }
  EXPECT_EQ(findings.Report(), "");
  EXPECT_GT(findings.count("results compared byte by byte"), 0);
}

}  // namespace
}  // namespace ballpiston::torture
