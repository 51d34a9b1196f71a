// The server is killed again and again, at random times and at every failpoint, while clients call
// all its methods.
#include "absl/cleanup/cleanup.h"
#include "server/status/failpoint.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/visitor.h"
#include "tests/support/stand_in_slurm.h"

namespace ballpiston::torture {
namespace {

// If a failpoint was never passed, the server is started up to this many times more, each time with
// a longer wait.
constexpr int kMostFurtherLives = 30;
constexpr int kKilled = 128 + SIGKILL;

// The most frequent failpoints are passed at every block, the rarest once or twice in a life.
int MostPasses(std::string_view failpoint) {
  if (failpoint.starts_with("store.") || failpoint.starts_with("checkpoint.")) return 30;
  if (failpoint.starts_with("block.") || failpoint == "resume.point") return 20;
  return failpoint.starts_with("stop.") ? 1 : 3;
}

// True if the server passes the failpoint when SIGTERM stops it, if not before.
bool ComesWithStop(std::string_view failpoint) {
  return failpoint.starts_with("stop.") || failpoint.starts_with("checkpoint.");
}

struct Scene {
  ServerSetUp server = {};
  std::chrono::milliseconds longest_life;
  // If the server does not pass the failpoint within this time, the test kills it.
  std::chrono::milliseconds wait_for_failpoint;
  std::vector<v1::EnsembleSpec> questions;
  std::vector<std::string_view> failpoints;
  int kills = 0;
};

class Killer {
 public:
  Killer(ConnectedServer& server, const Scene& scene, Findings& findings)
      : server_(server), scene_(scene), findings_(findings) {}

  // Half of them at random, half at failpoints, in turn. Then at each failpoint that is left.
  void KillManyTimes() {
    const std::vector<std::string_view>& failpoints = scene_.failpoints;
    for (int i = 0; i < scene_.kills; ++i) {
      if (i % 2 == 0) {
        KillAtRandom();
      } else {
        const size_t turn = static_cast<size_t>(i) / 2;
        KillAt(failpoints[turn % failpoints.size()]);
      }
    }
    for (const std::string_view failpoint : failpoints) {
      for (int i = 1; i <= kMostFurtherLives && kills_at_[failpoint] == 0; ++i) {
        KillAt(failpoint, i);
      }
      EXPECT_GT(kills_at_[failpoint], 0) << failpoint << " was never passed";
    }
    findings_.Count("failpoints", static_cast<int64_t>(failpoints.size()));
  }

 private:
  // In one case of four the random life begins with the process, before the server is ready.
  void KillAtRandom() {
    server_.Spawn();
    if (Pick(0, 3) != 0) server_.AwaitReady();
    const std::chrono::milliseconds life(Pick(0, static_cast<int>(scene_.longest_life.count())));
    const auto early = server_.AwaitEnd(life);
    if (early) return findings_.Wrong(absl::StrCat("ended by itself: ", server_.log()));
    server_.KillHard();
    findings_.Count("kills at random");
  }

  // Kills at the first pass of the failpoint, or at a random pass if it has killed before. Waits up
  // to `waits` times as long as usual for the kill.
  void KillAt(std::string_view failpoint, int waits = 1) {
    server_.Spawn(Armed(failpoint));
    if (server_.AwaitReady() && ComesWithStop(failpoint)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(Pick(0, 300)));
      server_.Signal(SIGTERM);
    }
    const auto end = server_.AwaitEnd(waits * scene_.wait_for_failpoint);
    if (!end) server_.KillHard();
    const bool stopped = end && *end == 0 && ComesWithStop(failpoint);
    const bool passed = end && !stopped;
    findings_.Count(passed ? "kills at failpoints" : "failpoints not passed");
    if (passed) ++kills_at_[failpoint];
    if (passed && *end != kKilled) {
      findings_.Wrong(absl::StrCat(std::string(failpoint), ": ended with ", *end));
    }
  }

  std::string Armed(std::string_view failpoint) {
    const bool first = kills_at_[failpoint] == 0;
    const bool when_ready = !failpoint.starts_with("resume.") && (first || Pick(0, 1) == 0);
    const int pass = Pick(1, first ? 1 : MostPasses(failpoint));
    return absl::StrCat(std::string(failpoint), when_ready ? ":ready+" : ":", pass);
  }

  int Pick(int least, int most) { return std::uniform_int_distribution<int>(least, most)(random_); }

  ConnectedServer& server_;
  const Scene& scene_;
  Findings& findings_;
  std::map<std::string_view, int> kills_at_;
  std::mt19937_64 random_{20};
};

std::set<std::string> NamesOn(ConnectedServer& server) {
  std::set<std::string> names;
  for (const v1::EnsembleJob& job : OrThrow(server.NewClient().List())) {
    EXPECT_TRUE(names.insert(job.name()).second);
  }
  return names;
}

std::vector<std::string_view> Failpoints(bool of_slurm) {
  std::vector<std::string_view> failpoints;
  for (const std::string_view failpoint : server::kFailpoints) {
    if (failpoint.starts_with("cluster.") == of_slurm) failpoints.push_back(failpoint);
  }
  return failpoints;
}

void KillUnderVisitors(const Scene& scene, Findings& findings) {
  Exam exam;
  exam.questions = scene.questions;
  exam.answers = UndisturbedAnswers(exam.questions);

  ConnectedServer server(scene.server);
  std::vector<Visitor> visitors;
  for (int i = 0; i < Size(2, 6); ++i) {
    visitors.emplace_back(server.Connect(), exam, static_cast<uint64_t>(i), findings);
  }
  std::atomic<bool> enough = false;
  std::vector<std::jthread> threads;
  for (Visitor& visitor : visitors) {
    threads.emplace_back([&] { visitor.VisitUntil(enough); });
  }
  // If an exception ends the test, the visits end too. They need a server for that.
  absl::Cleanup end_visits = [&] {
    enough = true;
    server.KillHard();
    server.Start();
  };
  Killer(server, scene, findings).KillManyTimes();

  // No client may have compared a result before a kill. The last server therefore runs until one
  // has.
  server.Start();
  AwaitThat([&] { return findings.count("results compared byte by byte") > 0; });
  enough = true;
  threads.clear();  // waits for them
  std::move(end_visits).Cancel();
  std::set<std::string> expected;
  for (Visitor& visitor : visitors) {
    visitor.CheckAll();
    expected.merge(visitor.names());
  }
  findings.Count("promises broken", 0);  // so that this row is printed
  EXPECT_EQ(NamesOn(server), expected);  // no job is lost, doubled, or back after its deletion
}

TEST(Kills, LoseNothingThatWasAcknowledgedAndCountNothingTwice) {
  Findings findings("kills");
  const std::vector<std::string_view> failpoints = Failpoints(false);
  KillUnderVisitors({.longest_life = std::chrono::milliseconds(600),
                     .wait_for_failpoint = std::chrono::milliseconds(1500),
                     .questions = Questions(),
                     .failpoints = failpoints,
                     .kills = Size(8, 1000)},
                    findings);
}

// Lives long enough for workers to be submitted and files to be read. Workers of a killed server
// run on.
TEST(Kills, OfAServerWithAClusterLoseNothingAndCountNothingTwice) {
  Findings findings("kills of a server with a cluster");
  const StandInSlurm slurm;
  const std::vector<std::string> flags = {
      "--executor=slurm",          "--cluster-folder",          slurm.shared_folder(),
      "--cluster-least-seconds=0", "--cluster-lease-seconds=1", "--cluster-timeout-seconds=3",
      "--slurm-query-seconds=1",   "--slurm-workers=4"};
  // In the short form all questions go to the cluster, so the server soon passes the cluster's
  // failpoints.
  std::vector<v1::EnsembleSpec> questions = LargeQuestions();
  if (ShareOfFullSize() > 0) {
    for (v1::EnsembleSpec& question : Questions()) questions.push_back(std::move(question));
  }
  KillUnderVisitors({.server = {.workers = 1, .flags = flags, .launcher = slurm.Launcher()},
                     .longest_life = std::chrono::seconds(HoldsToTimes() ? 4 : 2),
                     .wait_for_failpoint = std::chrono::seconds(6),
                     .questions = std::move(questions),
                     .failpoints = Failpoints(true),
                     .kills = Size(4, 200)},
                    findings);
  findings.Count("workers of the cluster", slurm.tasks());
  EXPECT_GT(slurm.tasks(), 0);
}

}  // namespace
}  // namespace ballpiston::torture
