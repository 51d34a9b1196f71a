#include "server/cluster/slurm_workers.h"

#include "tests/support/preamble.h"
#include "tests/support/scoped.h"

namespace ballpiston::server {
namespace {

using std::chrono::milliseconds;

// Slurm's tools: their answers, and the calls that they got.
struct FakeSlurm {
  SlurmQueue queue = {};
  absl::Status submits = {}, queries = {};
  size_t largest_array = 1'000'000;
  size_t room = 1'000'000;  // for workers, under a limit of the account
  std::vector<size_t> submitted = {};
  int asked = 0, cancelled = 0, waiting_cancelled = 0;
};

class FakeTools : public SlurmTools {
 public:
  explicit FakeTools(FakeSlurm& slurm) : SlurmTools({}, "bp-me", "/shared"), slurm_(slurm) {}

  absl::Status Submit(size_t workers) override {
    if (!slurm_.submits.ok()) return slurm_.submits;
    if (workers > slurm_.largest_array) {
      return absl::UnavailableError("sbatch: Invalid job array specification");
    }
    slurm_.submitted.push_back(workers);
    if (workers > slurm_.room) return absl::UnavailableError("sbatch: AssocMaxSubmitJobLimit");
    return absl::OkStatus();
  }
  absl::StatusOr<SlurmQueue> Query() override {
    ++slurm_.asked;
    if (!slurm_.queries.ok()) return slurm_.queries;
    return slurm_.queue;
  }
  absl::Status Cancel(bool also_running) override {
    ++(also_running ? slurm_.cancelled : slurm_.waiting_cancelled);
    return absl::OkStatus();
  }

 private:
  FakeSlurm& slurm_;
};

class SlurmWorkersTest : public testing::Test {
 protected:
  // Every look may query.
  SlurmWorkers New(SlurmOptions options = {.workers = 10, .query_interval = milliseconds(0)}) {
    return SlurmWorkers(
        options, std::make_unique<FakeTools>(slurm_), [this] { return work_; },
        [this] { return ready_(); });
  }

  FakeSlurm slurm_;
  FolderStatus work_;
  std::function<absl::Status()> ready_ = [] { return absl::OkStatus(); };
};

TEST_F(SlurmWorkersTest, AsManyWorkersAreSubmittedAsThereAreLeases) {
  SlurmWorkers workers = New();
  work_ = {.waiting_leases = 3, .taken_leases = 2};
  workers.Look();
  slurm_.queue = {.waiting = 1, .running = 2};
  work_.claims = 2;
  workers.Look();
  slurm_.queue = {.waiting = 0, .running = 5};
  workers.Look();
  EXPECT_THAT(slurm_.submitted, ElementsAre(5, 2));
  EXPECT_EQ(slurm_.cancelled, 0);
  EXPECT_EQ(workers.Status().queue.running, 5u);
  EXPECT_EQ(workers.Status().problem, "");
}

TEST_F(SlurmWorkersTest, TheFlagLimitsTheWorkersAndTheClusterLimitsTheArrays) {
  work_ = {.waiting_leases = 100};
  New({.workers = 10, .max_array_size = 4}).Look();
  EXPECT_THAT(slurm_.submitted, ElementsAre(4, 4, 2));
  slurm_ = {.largest_array = 3};
  New().Look();
  EXPECT_THAT(slurm_.submitted, ElementsAre(2, 2, 2, 2, 2));
}

TEST_F(SlurmWorkersTest, WithoutLeasesTheQueueIsEmptiedAndNotAskedAgain) {
  SlurmWorkers workers = New();
  slurm_.queue = {.waiting = 1, .running = 2};
  for (int i = 0; i < 2; ++i) workers.Look();
  EXPECT_EQ(slurm_.cancelled, 1);
  slurm_.queue = {};
  for (int i = 0; i < 5; ++i) workers.Look();
  EXPECT_EQ(slurm_.asked, 3);
  EXPECT_EQ(slurm_.cancelled, 1);
}

// A server that has just started, the time between two jobs, and a folder that cannot be used.
TEST_F(SlurmWorkersTest, WorkersStayWhileTheirLeasesMayComeBack) {
  SlurmWorkers workers = New();
  slurm_.queue = {.waiting = 1, .running = 2};
  for (const double leases : {0, 3, 0, 3}) {
    work_ = {.waiting_leases = leases};
    workers.Look();
  }
  work_ = {.problem = "the folder is gone"};
  for (int i = 0; i < 5; ++i) workers.Look();
  EXPECT_EQ(slurm_.cancelled, 0);
}

TEST_F(SlurmWorkersTest, TheQueueIsAskedOnceInAnInterval) {
  SlurmWorkers workers = New({.workers = 10, .query_interval = std::chrono::hours(1)});
  work_ = {.waiting_leases = 3};
  for (int i = 0; i < 5; ++i) workers.Look();
  EXPECT_EQ(slurm_.asked, 1);
  EXPECT_THAT(slurm_.submitted, ElementsAre(3));
}

TEST_F(SlurmWorkersTest, AProblemIsShownUntilItIsGone) {
  SlurmWorkers workers = New();
  work_ = {.waiting_leases = 5};
  slurm_.submits = absl::UnavailableError("sbatch: invalid partition specified: late");
  workers.Look();
  EXPECT_THAT(workers.Status().problem, HasSubstr("invalid partition"));
  slurm_.submits = absl::OkStatus();
  workers.Look();
  EXPECT_EQ(workers.Status().problem, "");
  slurm_.queries = absl::UnavailableError("squeue: no controller");
  workers.Look();
  EXPECT_EQ(workers.Status().problem, "squeue: no controller");
  work_ = {};  // without work too
  slurm_.queries = absl::OkStatus();
  workers.Look();
  EXPECT_EQ(workers.Status().problem, "");
}

TEST_F(SlurmWorkersTest, AFolderThatIsNotReadyGetsNoWorkers) {
  SlurmWorkers workers = New();
  work_ = {.waiting_leases = 5};
  ready_ = [] { return absl::ResourceExhaustedError("no space left"); };
  workers.Look();
  EXPECT_EQ(workers.Status().problem, "no space left");
  ready_ = []() -> absl::Status { throw std::runtime_error("no memory left"); };
  workers.Look();
  EXPECT_EQ(workers.Status().problem, "no memory left");
  EXPECT_THAT(slurm_.submitted, IsEmpty());
}

TEST_F(SlurmWorkersTest, ARefusedNumberIsHalvedAndAnAcceptedOneDoubled) {
  SlurmWorkers workers = New({.workers = 40, .query_interval = milliseconds(0)});
  work_ = {.waiting_leases = 40};
  slurm_.room = 11;
  for (int i = 0; i < 3; ++i) workers.Look();
  slurm_.queue = {.waiting = 0, .running = 10};
  slurm_.room = 1'000'000;
  for (int i = 0; i < 2; ++i) {
    work_.claims += 20;
    workers.Look();
  }
  EXPECT_THAT(slurm_.submitted, ElementsAre(40, 20, 10, 20, 30));
}

// One worker is tried at a time. The fault is shown until this worker takes a lease.
TEST_F(SlurmWorkersTest, WorkersThatFailAreTriedOneByOne) {
  struct Row {
    SlurmQueue queue;
    double claims;
    const char* problem;
    std::vector<size_t> submitted;
    int waiting_cancelled;
    double leases = 5;
  };
  const SlurmQueue never = {.waiting = 1, .running = 2, .never = "PartitionTimeLimit"};
  const Row rows[] = {{{}, 0, "", {5}, 0},
                      {{}, 0, "without taking a lease", {}, 0},
                      {{}, 0, "without taking a lease", {}, 0, 0},  // none for a moment
                      {{}, 0, "without taking a lease", {1}, 0},
                      {{.running = 1}, 0, "without taking a lease", {}, 0},
                      {{}, 0, "without taking a lease", {}, 0},
                      {{}, 0, "without taking a lease", {1}, 0},
                      {{.running = 1}, 1, "", {2}, 0},
                      {never, 1, "for ever: PartitionTimeLimit", {}, 1},
                      {{.running = 2}, 2, "for ever: PartitionTimeLimit", {1}, 0},
                      {never, 3, "for ever: PartitionTimeLimit", {}, 1},
                      {{}, 3, "for ever: PartitionTimeLimit", {1}, 0},
                      {{.waiting = 1}, 3, "for ever: PartitionTimeLimit", {}, 0},
                      {{.running = 1}, 4, "", {2}, 0},
                      {never, 4, "for ever: PartitionTimeLimit", {}, 1},
                      {{.running = 5}, 4, "", {}, 0},
                      // Five workers run on. The first two that are submitted beside them end;
                      // the leases of the five hide this (`submitted_`).
                      {{.running = 5}, 4, "", {1}, 0, 10},
                      {{.running = 5}, 4, "", {2}, 0, 10},
                      {{.running = 7}, 4, "", {3}, 0, 10},
                      // All but the five end once and are replaced. The next ones run.
                      {{.running = 5}, 4, "", {5}, 0, 10},
                      {{.running = 10}, 4, "", {}, 0, 10},
                      // All but the five end, and so do their successors, which waited.
                      {{.running = 5}, 4, "", {5}, 0, 10},
                      {{.waiting = 5, .running = 5}, 4, "", {}, 0, 10},
                      {{.running = 5}, 4, "without taking a lease", {}, 0, 10},
                      {{.running = 5}, 4, "without taking a lease", {1}, 0, 10},
                      {{.running = 6}, 9, "", {2}, 0, 10},
                      {{}, 11, "", {4}, 0, 10},  // each had taken a lease
                      {{.running = 4}, 11, "", {}, 0, 0},
                      {{}, 11, "", {5}, 0}};  // they ended while no lease waited
  SlurmWorkers workers = New();
  for (const Row& row : rows) {
    SCOPED_TRACE(&row - rows);
    slurm_ = {.queue = row.queue};
    work_ = {.waiting_leases = row.leases, .claims = row.claims};
    workers.Look();
    EXPECT_THAT(workers.Status().problem, HasSubstr(row.problem));
    EXPECT_EQ(workers.Status().problem == "", row.problem == absl::string_view());
    EXPECT_EQ(slurm_.submitted, row.submitted);
    EXPECT_EQ(slurm_.waiting_cancelled, row.waiting_cancelled);
    EXPECT_EQ(slurm_.cancelled, 0);
  }
}

// A script in the place of the tools, in a folder with a name of two words.
class SlurmToolsTest : public testing::Test {
 protected:
  void Install(const std::string& tool, const std::string& script) {
    const std::string path = folder_.File(tool);
    WriteFile(path, "#!/bin/sh\n" + script);
    chmod(path.c_str(), 0700);
  }
  SlurmTools New(const SlurmOptions& options = {}) { return {options, "bp-me", folder_.path()}; }

  const TemporaryFolder folder_{};
  const ScopedVariable path_{"PATH", folder_.path() + ":" + std::getenv("PATH")};
};

TEST_F(SlurmToolsTest, EachWordArrivesAsItIs) {
  Install("sbatch", "printf '%s\\0' \"$@\" >\"${0%/*}/words\"");
  const std::vector<std::string> options = {"--comment=two  words", "--a=it's \"$HOME\" `id` \\",
                                            "--b=two\nlines\n", "--c=*;#&|<>~", ""};
  EXPECT_OK(New({.account = "an account", .cluster = "c", .sbatch_options = options}).Submit(3));
  std::vector<std::string> words = absl::StrSplit(Contents(folder_.File("words")), '\0');
  words.pop_back();  // after the last zero
  EXPECT_EQ(words.front(), "--clusters=c");
  EXPECT_THAT(words, Contains("--array=0-2"));
  EXPECT_THAT(words, Contains("--account=an account"));
  ASSERT_GT(words.size(), options.size());
  words.erase(words.begin(), words.end() - static_cast<std::ptrdiff_t>(options.size()));
  EXPECT_EQ(words, options);
}

TEST_F(SlurmToolsTest, VariablesThatChangeTheToolsAreRemoved) {
  Install("sbatch", "env >\"${0%/*}/variables\"");
  const ScopedVariable conf("SLURM_CONF", "/conf"), token("SLURM_JWT", "t"),
      job("SLURM_JOB_ID", "7"), partition("SBATCH_PARTITION", "late"),
      format("SQUEUE_FORMAT", "%A"), cancel("SCANCEL_USER", "me");
  EXPECT_OK(New().Submit(1));
  const std::vector<std::string> variables =
      absl::StrSplit(Contents(folder_.File("variables")), '\n');
  EXPECT_THAT(variables, testing::IsSupersetOf({"SLURM_CONF=/conf", "SLURM_JWT=t"}));
  EXPECT_THAT(variables,
              Not(Contains(testing::ContainsRegex("^(SLURM_JOB|SBATCH|SQUEUE|SCANCEL)"))));
}

// The states in the manual of squeue.
TEST_F(SlurmToolsTest, AWorkerInTheQueueIsWaitingOrRunningOrHasEnded) {
  const auto queue_of = [&](const std::string& states) {
    Install("squeue",
            "echo 'squeue: warning' >&2; echo PENDING; printf '%s|None\\n' nonsense " + states);
    const absl::StatusOr<SlurmQueue> queue = New().Query();
    EXPECT_OK(queue);
    return std::pair(queue->waiting, queue->running);
  };
  EXPECT_THAT(queue_of("PENDING REQUEUED REQUEUE_HOLD"), Pair(3, 0));
  EXPECT_THAT(queue_of("RUNNING COMPLETING SUSPENDED"), Pair(0, 3));
  EXPECT_THAT(queue_of("CANCELLED COMPLETED FAILED TIMEOUT"), Pair(0, 0));
}

// The server ends by fflush of all streams and _Exit.
TEST_F(SlurmToolsTest, AToolThatRunsLocksNoStream) {
  const std::string started = folder_.File("started"), go = folder_.File("go");
  ASSERT_EQ(mkfifo(go.c_str(), 0600), 0);
  Install("squeue", "echo 1 >\"${0%/*}/started\"; cat \"${0%/*}/go\"");
  std::thread thread([&] { EXPECT_OK(New().Query().status()); });
  AwaitThat([&] { return std::filesystem::exists(started); });
  std::fflush(nullptr);
  WriteFile(go, "");  // `cat` ends
  thread.join();
}

TEST_F(SlurmToolsTest, OnlyWaitingWorkersAreCancelledUnlessToldOtherwise) {
  Install("scancel", "echo \"$*\" >>\"${0%/*}/words\"");
  EXPECT_OK(New().Cancel(false));
  EXPECT_OK(New().Cancel(true));
  EXPECT_EQ(Contents(folder_.File("words")),
            "--me --name=bp-me --state=PENDING\n--me --name=bp-me\n");
}

TEST_F(SlurmToolsTest, AnErrorHasTheToolsMessage) {
  const auto error = [&](const std::string& script) {
    Install("scancel", script);
    return std::string(New().Cancel(true).message());
  };
  EXPECT_EQ(error("echo 'scancel: error: no controller' >&2; echo 'scancel: later' >&2; exit 1"),
            "scancel: no controller; later");
  EXPECT_EQ(error("exit 3"), "scancel: exit code 3");
  EXPECT_EQ(error("kill -KILL $$"), "scancel was killed; its time limit is 60 s");
  EXPECT_EQ(error("kill -SEGV $$"), "scancel: ended by signal 11");
  std::filesystem::remove(folder_.File("scancel"));
  for (const std::string tool : {"env", "timeout"}) {
    std::filesystem::create_symlink("/usr/bin/" + tool, folder_.File(tool));
  }
  const ScopedVariable no_slurm("PATH", folder_.path()), english("LC_ALL", "C");
  EXPECT_THAT(New().Cancel(true),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("failed to run command")));
}

TEST(SlurmQueue, AWorkerThatAnOperatorMustHelpWaitsForEver) {
  for (const std::string reason :
       {"InvalidAccount", "PartitionTimeLimit", "launch failed requeued held"}) {
    EXPECT_EQ(ParseQueue("PENDING|" + reason).never, reason);
    EXPECT_EQ(ParseQueue("RUNNING|" + reason).never, "");
  }
  for (const std::string passing : {"None", "Priority", "QOSMaxJobsPerUserLimit"}) {
    EXPECT_EQ(ParseQueue("PENDING|" + passing).never, "") << passing;
  }
}

TEST(LongestChunk, IsHalfOfTheTimeLimitLessTheEnd) {
  EXPECT_EQ(LongestChunk({.time_limit_minutes = 60}), 0.5 * (3600 - 90));
  EXPECT_EQ(LongestChunk({.time_limit_minutes = 1}), 0.5);
}

}  // namespace
}  // namespace ballpiston::server
