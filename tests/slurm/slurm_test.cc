// Jobs on a whole Slurm cluster whose parts are killed. Whatever happens, a job gives the bytes that
// threads alone give, and each sample counts once.
//
// The clusters have no accounting (slurmdbd): nothing here needs it.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <chrono>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "tests/slurm/cluster.h"
#include "tests/slurm/sweep.h"

namespace ballpiston {
namespace {

// A pause between two faults, not for an event.
void Pause(std::chrono::milliseconds time) { std::this_thread::sleep_for(time); }

// ---- without faults ----

TEST(Slurm, ASweepOnTheClusterGivesTheSameBytes) {
  Sweep sweep;
  sweep.Submit();
  sweep.AwaitRunningTasks();
  sweep.ExpectTheSameBytes();
  const SlurmCounts counts = sweep.Counts();
  EXPECT_GT(counts.chunks, 0);
  EXPECT_EQ(counts.lost, 0);
  EXPECT_EQ(counts.refused, 0);
  EXPECT_EQ(counts.problem, "");
  EXPECT_NE(sweep.cluster().Tool({"sacct"}).exit_code, 0) << "the cluster has accounting";
}

// ---- the server ----

TEST(Slurm, ThreadsAndClusterGiveTheSameBytesThroughKillsOfTheServer) {
  Sweep sweep({.samples = 2'000'000, .workers = 2});
  sweep.Submit();
  std::mt19937 random(1);
  for (int kill = 0; kill < 4; ++kill) {
    Pause(std::chrono::milliseconds(500 + random() % 3000));
    sweep.KillServer();
  }
  sweep.ExpectTheSameBytes();
}

}  // namespace
}  // namespace ballpiston
