#include "server/cluster/slurm_workers.h"

#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

using std::chrono::milliseconds;

// Slurm's tools: their answers, and the calls that they got.
struct FakeSlurm {
  SlurmQueue queue = {};
  absl::Status submits = {}, queries = {};
  size_t largest_array = 1'000'000;
  std::vector<size_t> submitted = {};
  int asked = 0, cancelled = 0;
};

class FakeTools : public SlurmTools {
 public:
  explicit FakeTools(FakeSlurm& slurm) : SlurmTools({}, "bp-me", "/shared"), slurm_(slurm) {}

  absl::Status Submit(size_t workers, const std::stop_token&) override {
    if (!slurm_.submits.ok()) return slurm_.submits;
    if (workers > slurm_.largest_array) {
      return absl::UnavailableError("sbatch: Invalid job array specification");
    }
    slurm_.submitted.push_back(workers);
    return absl::OkStatus();
  }
  absl::StatusOr<SlurmQueue> Query(const std::stop_token&) override {
    ++slurm_.asked;
    if (!slurm_.queries.ok()) return slurm_.queries;
    return slurm_.queue;
  }
  absl::Status Cancel(const std::stop_token&) override {
    ++slurm_.cancelled;
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
        [this] { return ready_; });
  }

  FakeSlurm slurm_;
  FolderStatus work_;
  absl::Status ready_;
};

TEST_F(SlurmWorkersTest, AsManyWorkersAreSubmittedAsThereAreLeases) {
  SlurmWorkers workers = New();
  work_ = {.waiting_leases = 3, .taken_leases = 2};
  workers.Look();
  slurm_.queue = {.waiting = 1, .running = 2};
  workers.Look();
  slurm_.queue = {.waiting = 0, .running = 5};
  workers.Look();
  EXPECT_THAT(slurm_.submitted, ElementsAre(5, 2));
  EXPECT_EQ(slurm_.cancelled, 0);
  EXPECT_EQ(workers.Status().queue.running, 5u);
  EXPECT_EQ(workers.Status().problem, "");
}

TEST_F(SlurmWorkersTest, NoMoreWorkersThanTheFlagSays) {
  SlurmWorkers workers =
      New({.workers = 10, .max_array_size = 4, .query_interval = milliseconds(0)});
  work_ = {.waiting_leases = 100};
  workers.Look();
  EXPECT_THAT(slurm_.submitted, ElementsAre(4, 4, 2));
}

TEST_F(SlurmWorkersTest, WithoutLeasesTheQueueIsEmptiedAndNotAskedAgain) {
  SlurmWorkers workers = New();
  slurm_.queue = {.waiting = 1, .running = 2};
  workers.Look();
  EXPECT_EQ(slurm_.cancelled, 1);
  slurm_.queue = {};
  for (int i = 0; i < 5; ++i) workers.Look();
  EXPECT_EQ(slurm_.asked, 2);
  EXPECT_EQ(slurm_.cancelled, 1);
}

TEST_F(SlurmWorkersTest, TheQueueIsAskedOnceInAnInterval) {
  SlurmWorkers workers = New({.workers = 10, .query_interval = std::chrono::hours(1)});
  work_ = {.waiting_leases = 3};
  for (int i = 0; i < 5; ++i) workers.Look();
  EXPECT_EQ(slurm_.asked, 1);
  EXPECT_THAT(slurm_.submitted, ElementsAre(3));
}

TEST_F(SlurmWorkersTest, ArraysShrinkToTheClustersLimit) {
  slurm_.largest_array = 3;
  SlurmWorkers workers = New();
  work_ = {.waiting_leases = 5};
  workers.Look();
  EXPECT_THAT(slurm_.submitted, ElementsAre(2, 2, 1));
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
}

TEST_F(SlurmWorkersTest, AFolderThatIsNotReadyGetsNoWorkers) {
  ready_ = absl::ResourceExhaustedError("no space left");
  SlurmWorkers workers = New();
  work_ = {.waiting_leases = 5};
  workers.Look();
  EXPECT_THAT(slurm_.submitted, IsEmpty());
  EXPECT_EQ(workers.Status().problem, "no space left");
}

TEST_F(SlurmWorkersTest, WorkersThatEndInVainAreSubmittedOneByOne) {
  SlurmWorkers workers = New({.workers = 10, .query_interval = milliseconds(0)});
  work_ = {.waiting_leases = 5};
  workers.Look();
  workers.Look();
  EXPECT_THAT(workers.Status().problem, HasSubstr("without taking a lease"));
  EXPECT_THAT(slurm_.submitted, ElementsAre(5));
}

TEST_F(SlurmWorkersTest, WorkersThatWouldWaitForEverAreCancelled) {
  SlurmWorkers workers = New();
  work_ = {.waiting_leases = 5};
  slurm_.queue = {.waiting = 5, .running = 0, .never = "PartitionTimeLimit"};
  workers.Look();
  EXPECT_EQ(slurm_.cancelled, 1);
  EXPECT_THAT(workers.Status().problem, HasSubstr("for ever: PartitionTimeLimit"));
}

TEST(SlurmQueue, StatesAreCounted) {
  const SlurmQueue queue = ParseQueue(
      "PENDING|Priority\nPENDING|Resources\nRUNNING|None\nCOMPLETING|None\nFAILED|"
      "None\nnonsense\n");
  EXPECT_EQ(queue.waiting, 2u);
  EXPECT_EQ(queue.running, 2u);
  EXPECT_EQ(queue.never, "");
}

// The states in the manual of squeue.
TEST(SlurmQueue, AWorkerIsWaitingOrRunningOrHasEnded) {
  const auto counts = [](const std::string& state) {
    const SlurmQueue queue = ParseQueue(state + "|None");
    return std::pair(queue.waiting, queue.running);
  };
  for (const char* state : {"PENDING", "REQUEUED", "REQUEUE_HOLD"}) {
    EXPECT_THAT(counts(state), Pair(1, 0)) << state;
  }
  for (const char* state : {"RUNNING", "COMPLETING", "SUSPENDED"}) {
    EXPECT_THAT(counts(state), Pair(0, 1)) << state;
  }
  for (const char* state : {"CANCELLED", "COMPLETED", "TIMEOUT"}) {
    EXPECT_THAT(counts(state), Pair(0, 0)) << state;
  }
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
