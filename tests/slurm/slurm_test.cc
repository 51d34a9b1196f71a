// Jobs on a whole Slurm cluster whose parts are killed. Whatever happens, a job gives the bytes
// that threads alone give, and each sample counts once.
//
// The clusters have no accounting (slurmdbd): nothing here needs it.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "tests/slurm/cluster.h"
#include "tests/slurm/sweep.h"
#include "tests/support/await.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

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
  const ClusterCounts counts = sweep.Counts();
  EXPECT_GT(counts.chunks, 0);
  EXPECT_EQ(counts.lost, 0);
  EXPECT_EQ(counts.refused, 0);
  EXPECT_EQ(counts.problem, "");
  EXPECT_NE(sweep.cluster().Tool({"sacct"}).exit_code, 0) << "the cluster has accounting";
}

// ---- the server ----

TEST(Slurm, ThreadsAndClusterGiveTheSameBytesThroughKillsOfTheServer) {
  Sweep sweep({.workers = 2});
  sweep.Submit();
  std::mt19937 random(1);
  for (int kill = 0; kill < 4; ++kill) {
    Pause(std::chrono::milliseconds(500 + random() % 3000));
    sweep.KillServer();
  }
  sweep.ExpectTheSameBytes();
}

TEST(Slurm, CancellingTheJobEmptiesTheQueue) {
  Sweep sweep({.samples = 100'000'000});
  sweep.Submit();
  sweep.AwaitRunningTasks();
  EXPECT_THAT(sweep.server().Client({"cancel", sweep.job()}), ExitsWith(0));
  AwaitThat([&] { return sweep.cluster().Queue().empty(); });
  AwaitThat([&] { return sweep.Workers().empty(); });
  AwaitThat([&] { return sweep.Counts().leases == 0; });
}

// squeue, with a line in a file for each call.
TEST(Slurm, TheQueueIsAskedForAtMostOnceInAnInterval) {
  const TemporaryFolder folder;
  const std::string calls = folder.File("calls"), program = folder.File("squeue");
  WriteFile(program,
            absl::StrCat("#!/bin/sh\ndate +%s%N >>", calls, "\nexec /usr/bin/squeue \"$@\"\n"));
  chmod(program.c_str(), 0700);
  constexpr double kInterval = 2;
  Sweep sweep({.flags = Split("--slurm-max-array-size 2"), .path = folder.path()});
  std::filesystem::remove(calls);
  const auto start = std::chrono::steady_clock::now();
  for (int seed = 1; seed <= 3; ++seed) sweep.server().Submit(SweepOf(300'000, seed));
  sweep.Submit();
  EXPECT_THAT(sweep.server().Client({"watch", sweep.job()}), ExitsWith(0));
  const std::chrono::duration<double> span = std::chrono::steady_clock::now() - start;
  std::vector<double> times;
  for (const absl::string_view line : absl::StrSplit(Contents(calls), '\n', absl::SkipEmpty())) {
    times.push_back(1e-9 * std::stod(std::string(line)));
  }
  ASSERT_GT(times.size(), 3u);
  double least = HUGE_VAL;
  for (size_t i = 1; i < times.size(); ++i) least = std::min(least, times[i] - times[i - 1]);
  // A call may be written to the file late: also one that began before `start`. Therefore the calls
  // are counted, and the least distance is only noted.
  EXPECT_LE(kInterval * static_cast<double>(times.size() - 1), span.count() + kInterval);
  sweep.Note(absl::StrCat(times.size(), " calls of squeue, at least ", least, " s apart"));
  sweep.ExpectTheSameBytes();
}

// ---- slurmctld ----

class SlurmControllerKilled : public testing::TestWithParam<int> {};

TEST_P(SlurmControllerKilled, GivesTheSameBytes) {
  Sweep sweep;
  sweep.Submit();
  sweep.AwaitTasks();
  Pause(std::chrono::seconds(GetParam()));
  sweep.cluster().Do("kill-controller");
  Pause(std::chrono::seconds(2));
  sweep.cluster().Do("start-controller");
  sweep.ExpectTheSameBytes();
}

INSTANTIATE_TEST_SUITE_P(Slurm, SlurmControllerKilled, testing::Values(0, 1, 2, 5));

// Its connections stay open, and no answer comes.
TEST(Slurm, AControllerThatHangsGivesTheSameBytes) {
  Sweep sweep;
  sweep.Submit();
  sweep.AwaitRunningTasks();
  sweep.cluster().Do("pause-controller");
  Pause(std::chrono::seconds(10));
  sweep.cluster().Do("resume-controller");
  sweep.ExpectTheSameBytes();
}

// Without munge no tool of Slurm works.
TEST(Slurm, AClusterWithoutMungeIsUsedAgainWhenItIsBack) {
  Sweep sweep({.samples = 2'000'000});
  sweep.Submit();
  sweep.AwaitRunningTasks();
  sweep.cluster().Do("kill-munge");
  sweep.AwaitProblem("squeue");
  sweep.cluster().Do("start-munge");
  sweep.ExpectTheSameBytes();
  EXPECT_EQ(sweep.Counts().problem, "");
}

// Slurm gives the numbers of the lost arrays to other arrays.
TEST(Slurm, LostStateGivesTheSameBytes) {
  Sweep sweep({.flags = Split("--slurm-max-array-size 4")});
  sweep.Submit();
  sweep.AwaitRunningTasks();
  const std::vector<pid_t> lost = sweep.Workers();
  sweep.cluster().Do("kill-controller");
  sweep.cluster().Do("lose-state");
  sweep.cluster().Do("start-controller");
  // Slurm kills what it no longer knows, by number: a new job with that number would end too.
  AwaitThat([&] {
    return std::all_of(lost.begin(), lost.end(), [](pid_t worker) { return kill(worker, 0) != 0; });
  });
  const ProcessResult foreign =
      sweep.cluster().Tool({"sbatch", "--parsable", "--output=/dev/null", "--wrap=sleep 1000"});
  EXPECT_THAT(foreign, ExitsWith(0));
  sweep.ExpectTheSameBytes();
  AwaitThat([&] { return sweep.Counts().leases == 0; });
  EXPECT_EQ(sweep.cluster().Queue().size(), 1u) << "the job of others is cancelled";
  sweep.Note("the number of the job of others: " + foreign.out.substr(0, foreign.out.find('\n')));
}

// ---- nodes ----

TEST(Slurm, ANodeThatDiesWithItsTasksGivesTheSameBytes) {
  Sweep sweep({.cluster = {"SlurmdTimeout=5"}});
  sweep.Submit();
  sweep.AwaitRunningTasks();
  sweep.cluster().Do("kill-node", "n1");
  sweep.ExpectTheSameBytes();
}

// Slurm notices only later that the tasks are gone.
TEST(Slurm, ANodeThatIsBackAtOnceGivesTheSameBytes) {
  Sweep sweep({.cluster = {"SlurmdTimeout=5"}});
  sweep.Submit();
  sweep.AwaitRunningTasks();
  sweep.cluster().Do("kill-node", "n1");
  sweep.cluster().Do("start-node", "n1");
  sweep.ExpectTheSameBytes();
}

// Its tasks run on, and later elsewhere a second time.
TEST(Slurm, ASlurmdThatDiesWithoutItsTasksGivesTheSameBytes) {
  Sweep sweep({.cluster = {"SlurmdTimeout=5"}});
  sweep.Submit();
  sweep.AwaitRunningTasks();
  sweep.cluster().Do("kill-slurmd", "n1");
  sweep.ExpectTheSameBytes();
}

TEST(Slurm, AKilledWorkerGivesTheSameBytes) {
  Sweep sweep;
  sweep.Submit();
  sweep.AwaitRunningTasks();
  for (const pid_t worker : sweep.Workers()) kill(worker, SIGKILL);
  sweep.ExpectTheSameBytes();
  EXPECT_GT(sweep.Counts().lost, 0);
}

// SIGUSR1 comes before the time limit: at Slurm's first look, which is within 30 s. Until then the
// workers are stopped, as on a machine that hangs.
TEST(Slurm, TasksThatReachTheirTimeLimitGiveTheSameBytes) {
  Sweep sweep({.flags = Split("--slurm-time-limit-minutes 1")});
  sweep.Submit();
  sweep.AwaitRunningTasks();
  const std::vector<pid_t> workers = sweep.Workers();
  for (const pid_t worker : workers) kill(worker, SIGSTOP);
  sweep.ExpectTheSameBytes();
  EXPECT_GT(sweep.Counts().lost, 0);
  sweep.Note(absl::StrCat(workers.size(), " workers were stopped"));
}

// The first worker takes a lease and ignores every signal but SIGKILL.
TEST(Slurm, ATaskThatHangsIsComputedAgainAfterItsTimeLimit) {
  const TemporaryFolder folder;
  const std::string worker = folder.File("worker");
  WriteFile(worker, absl::StrCat("#!/bin/sh\nif mkdir ", folder.File("hung"),
                                 " 2>/dev/null; then lease=$(ls \"$1/todo\" | head -n 1); "
                                 "mv \"$1/todo/$lease\" \"$1/taken/$lease.hung\"; "
                                 "trap '' USR1 TERM; while :; do sleep 1; done; fi\n",
                                 "exec ", BuildPath("bin/ballpiston-worker"), " \"$@\"\n"));
  Sweep sweep(
      {.flags = Joined({Split("--slurm-time-limit-minutes 1 --cluster-worker"), {worker}})});
  sweep.Submit();
  sweep.ExpectTheSameBytes();
  EXPECT_GT(sweep.Counts().lost, 0);
}

TEST(Slurm, PreemptedTasksGiveTheSameBytes) {
  Sweep sweep({.flags = Split("--slurm-partition spare")});
  sweep.Submit();
  sweep.AwaitRunningTasks();
  for (int node = 0; node < 2; ++node) {
    const ProcessResult urgent =
        sweep.cluster().Tool({"sbatch", "-p", "urgent", "--ntasks=4", "--nodes=1",
                              "--output=/dev/null", "--wrap=sleep 5"});
    EXPECT_THAT(urgent, ExitsWith(0));
  }
  bool requeued = false;
  AwaitThat([&] {
    for (const std::string& line : sweep.cluster().Queue()) {
      requeued = requeued || (absl::StrContains(line, "bp-") && absl::StrContains(line, "PENDING"));
    }
    return requeued;
  });
  sweep.ExpectTheSameBytes();
}

// ---- settings of the cluster ----

TEST(Slurm, ArraysShrinkToTheClustersMaxArraySize) {
  Sweep sweep({.cluster = {"MaxArraySize=3"}, .lease_seconds = 1});
  sweep.Submit();
  sweep.ExpectTheSameBytes();
  EXPECT_GT(sweep.Counts().chunks, 0);
  EXPECT_TRUE(sweep.server().AwaitLog("set --slurm-max-array-size"));
}

TEST(Slurm, ForgottenJobsGiveTheSameBytes) {
  Sweep sweep({.cluster = {"MinJobAge=2"}});
  sweep.Submit();
  sweep.AwaitRunningTasks();
  sweep.ExpectTheSameBytes();
  EXPECT_EQ(sweep.Counts().lost, 0);
}

TEST(Slurm, APartitionThatIsMadeLaterIsUsed) {
  Sweep sweep({.flags = Split("--slurm-partition late"), .samples = 2'000'000});
  sweep.Submit();
  sweep.AwaitProblem("invalid partition specified: late");
  sweep.cluster().Do("stop-controller");
  WriteFile(sweep.cluster().conf(),
            Contents(sweep.cluster().conf()) + "PartitionName=late Nodes=ALL MaxTime=60\n");
  sweep.cluster().Do("start-controller");
  sweep.AwaitRunningTasks();
  sweep.ExpectTheSameBytes();
  EXPECT_EQ(sweep.Counts().problem, "");
}

// ---- the shared folder ----

TEST(Slurm, AFolderThatOthersCanWriteIsUsedAfterItsRepair) {
  Sweep sweep;
  chmod(sweep.shared_folder().c_str(), 0777);
  sweep.Submit();
  sweep.AwaitProblem("can be written by other users");
  EXPECT_TRUE(sweep.cluster().Queue().empty());
  chmod(sweep.shared_folder().c_str(), 0700);
  sweep.AwaitRunningTasks();
  sweep.ExpectTheSameBytes();
  EXPECT_EQ(sweep.Counts().problem, "");
}

// A file system of its own, with room for the worker and little else.
class SmallDisk {
 public:
  explicit SmallDisk(std::string path) : path_(std::move(path)) {
    mounted_ = mount("ballpiston", path_.c_str(), "tmpfs", 0, "size=12m,mode=0700") == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(path_.c_str(), MNT_DETACH);
  }
  bool mounted() const { return mounted_; }
  void Fill() const {
    std::ofstream file(path_ + "/filler", std::ios::binary);
    const std::string bytes(4096, 'x');
    while (file.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush()) continue;
  }
  void Empty() const { std::filesystem::remove(path_ + "/filler"); }

 private:
  const std::string path_;
  bool mounted_ = false;
};

TEST(Slurm, AFullFolderIsUsedAfterItIsEmptied) {
  Sweep sweep;
  const SmallDisk disk(sweep.shared_folder());
  if (!disk.mounted()) GTEST_SKIP() << "may not mount a file system";
  disk.Fill();
  sweep.Submit();
  sweep.AwaitProblem("No space left on device");
  disk.Empty();
  sweep.AwaitRunningTasks();
  sweep.ExpectTheSameBytes();
  EXPECT_EQ(sweep.Counts().problem, "");
}

TEST(Slurm, AFolderThatFillsUpDuringTheTasksGivesTheSameBytes) {
  Sweep sweep;
  const SmallDisk disk(sweep.shared_folder());
  if (!disk.mounted()) GTEST_SKIP() << "may not mount a file system";
  sweep.Submit();
  sweep.AwaitRunningTasks();
  disk.Fill();
  Pause(std::chrono::seconds(8));
  disk.Empty();
  sweep.ExpectTheSameBytes();
}

}  // namespace
}  // namespace ballpiston
