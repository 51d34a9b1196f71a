// Jobs on a whole Slurm cluster whose parts are killed. Whatever happens, a job gives the bytes
// that threads alone give, and each sample counts once.
//
// The clusters have no accounting (slurmdbd): nothing here needs it.
#include <ostream>

#include "tests/slurm/sweep.h"
#include "tests/support/preamble.h"

namespace ballpiston {
namespace {

// A pause between two faults, not for an event.
void Pause(std::chrono::milliseconds time) { std::this_thread::sleep_for(time); }

// ---- faults ----

// What happens to a sweep, from its submission to its end.
struct Story {
  const char* name;
  SweepSetUp set_up;
  std::function<void(Sweep&)> tell;
  bool loses_leases = false;
};

void PrintTo(const Story& story, std::ostream* out) { *out << story.name; }

Story ControllerKilledAfter(const char* name, int seconds) {
  return {name, {}, [seconds](Sweep& sweep) {
            sweep.Submit();
            AwaitThat([&] { return !sweep.cluster().Queue().empty(); });
            Pause(std::chrono::seconds(seconds));
            sweep.cluster().Do("kill-controller");
            Pause(std::chrono::seconds(2));
            sweep.cluster().Do("start-controller");
          }};
}

// Verbs of the cluster, one after the other, while tasks run. Slurm notices after five seconds that
// a node does not answer.
Story Verbs(const char* name, const std::vector<std::pair<std::string, std::string>>& verbs) {
  return {name, {.cluster = {"SlurmdTimeout=5"}}, [verbs](Sweep& sweep) {
            sweep.SubmitAndAwaitTasks();
            for (const auto& [verb, node] : verbs) sweep.cluster().Do(verb, {node});
          }};
}

void KillServerFourTimes(Sweep& sweep) {
  sweep.Submit();
  std::mt19937 random(1);
  for (int kill = 0; kill < 4; ++kill) {
    Pause(std::chrono::milliseconds(500 + random() % 3000));
    sweep.server().KillHard();
    sweep.server().Start();
  }
}

// Its connections stay open, and no answer comes.
void PauseController(Sweep& sweep) {
  sweep.SubmitAndAwaitTasks();
  sweep.cluster().Do("pause-controller");
  Pause(std::chrono::seconds(10));
  sweep.cluster().Do("resume-controller");
}

// Without munge no tool of Slurm works.
void LoseMunge(Sweep& sweep) {
  sweep.SubmitAndAwaitTasks();
  sweep.cluster().Do("kill-munge");
  sweep.AwaitProblem("squeue");
  sweep.cluster().Do("start-munge");
}

void SignalWorkers(Sweep& sweep, int signal) {
  sweep.SubmitAndAwaitTasks();
  AwaitThat([&] { return !NamesIn(sweep.shared_folder() + "/taken").empty(); });
  for (const pid_t worker : sweep.Workers()) kill(worker, signal);
}

void PreemptTasks(Sweep& sweep) {
  sweep.SubmitAndAwaitTasks();
  for (int node = 0; node < 2; ++node) {
    const ProcessResult urgent =
        sweep.cluster().Tool({"sbatch", "-p", "urgent", "--ntasks=4", "--nodes=1",
                              "--output=/dev/null", "--wrap=sleep 5"});
    EXPECT_THAT(urgent, ExitsWith(0));
  }
  AwaitThat([&] {  // until a task waits again
    const std::vector<std::string> queue = sweep.cluster().Queue();
    return std::any_of(queue.begin(), queue.end(), [](const std::string& line) {
      return absl::StrContains(line, "bp-") && absl::StrContains(line, "PENDING");
    });
  });
}

std::vector<Story> Stories() {
  return {{"TheServerIsKilled", {.workers = 2}, KillServerFourTimes},
          ControllerKilledAfter("TheControllerIsKilledAtOnce", 0),
          ControllerKilledAfter("TheControllerIsKilledLater", 2),
          {"TheControllerHangs", {}, PauseController},
          {"MungeIsGoneForAWhile", {.samples = 2'000'000}, LoseMunge},
          Verbs("ANodeDiesWithItsTasks", {{"kill-node", "n1"}}),
          Verbs("ANodeIsBackAtOnce", {{"kill-node", "n1"}, {"start-node", "n1"}}),
          Verbs("SlurmdDiesWithoutItsTasks", {{"kill-slurmd", "n1"}}),
          {"WorkersAreKilled",
           {.samples = 2'000'000},
           [](Sweep& sweep) { SignalWorkers(sweep, SIGKILL); },
           true},
          // SIGUSR1 comes before the time limit, but the workers are stopped, as on a machine that
          // hangs.
          {"TasksReachTheirTimeLimit",
           {.flags = Split("--slurm-time-limit-minutes 1"), .samples = 2'000'000},
           [](Sweep& sweep) { SignalWorkers(sweep, SIGSTOP); },
           true},
          {"TasksArePreempted", {.flags = Split("--slurm-partition spare")}, PreemptTasks},
          {"SlurmForgetsEndedJobs", {.cluster = {"MinJobAge=2"}}, &Sweep::SubmitAndAwaitTasks},
          {"TheClustersArraysAreSmall",
           {.cluster = {"MaxArraySize=3"}, .lease_seconds = 1},
           &Sweep::SubmitAndAwaitTasks}};
}

class SlurmFault : public testing::TestWithParam<Story> {};

TEST_P(SlurmFault, GivesTheSameBytes) {
  Sweep sweep(GetParam().set_up);
  GetParam().tell(sweep);
  sweep.ExpectTheSameBytes();
  AwaitThat([&] { return sweep.Problem().empty(); });
  if (GetParam().loses_leases) {
    EXPECT_GT(sweep.Status().lost_leases(), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SlurmFault, testing::ValuesIn(Stories()),
                         [](const auto& story) { return story.param.name; });

// Slurm gives the numbers of the lost arrays to other arrays.
TEST(Slurm, LostStateGivesTheSameBytes) {
  Sweep sweep({.flags = Split("--slurm-max-array-size 4")});
  sweep.SubmitAndAwaitTasks();
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
  sweep.AwaitNoLeases();
  EXPECT_EQ(sweep.cluster().Queue().size(), 1u) << "the job of others is cancelled";
}

// ---- without faults ----

// The time-out is long, so no lease is late on a slow machine.
TEST(Slurm, ASweepOnTheClusterGivesTheSameBytes) {
  Sweep sweep({.timeout_seconds = 900});
  sweep.SubmitAndAwaitTasks();
  sweep.ExpectTheSameBytes();
  const v1::ClusterStatus status = sweep.Status();
  EXPECT_GT(status.chunks(), 0);
  EXPECT_EQ(status.lost_leases(), 0);
  EXPECT_EQ(status.refused_files(), 0);
  AwaitThat([&] { return sweep.Problem().empty(); });
  EXPECT_NE(sweep.cluster().Tool({"sacct"}).exit_code, 0) << "the cluster has accounting";
}

TEST(Slurm, CancellingTheJobEmptiesTheQueue) {
  Sweep sweep({.samples = 100'000'000});
  sweep.SubmitAndAwaitTasks();
  EXPECT_THAT(sweep.server().Client({"cancel", sweep.job()}), ExitsWith(0));
  AwaitThat([&] { return sweep.cluster().Queue().empty(); });
  AwaitThat([&] { return sweep.Workers().empty(); });
  sweep.AwaitNoLeases();
}

}  // namespace
}  // namespace ballpiston
