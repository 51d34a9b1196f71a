#include "server/cluster/slurm_executor.h"

#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "core/ensemble/experiment_kind.h"
#include "core/experiment/all_experiments.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/worker/chunk_file.h"
#include "server/worker/crash_mark.h"
#include "server/worker/task_run.h"
#include "tests/server/cluster/fake_slurm.h"
#include "tests/server/compute/run_requests.h"
#include "tests/server/compute/stepped_executor.h"
#include "tests/server/factory_opener.h"
#include "tests/server/worker/sample_leases.h"
#include "tests/support/await.h"
#include "tests/support/files.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr char kIdentity[] = "server1";

constexpr uint64_t kAllBlocks = std::numeric_limits<uint64_t>::max();

// One point of so many chunks: about 3 ms of one core, 6 ms, 12 ms and so on.
EnsembleSpec PointOfChunks(uint64_t chunks) {
  static const EnsembleSpec two = SpecOf(kFirstHit, Model::kBilliard, 10'000'000);
  static const uint64_t base = PointExperiment::Create(two, 0)->plan().SamplesIn(0);
  return SpecOf(kFirstHit, Model::kBilliard, static_cast<int64_t>(base * ((1 << chunks) - 1)));
}

class CoreOpener : public FactoryOpener {
 public:
  CoreOpener()
      : FactoryOpener([](const EnsembleSpec& spec, size_t index) {
          return PointExperiment::Create(spec, index);
        }) {}
  double MemoryOf(const EnsembleSpec& spec, size_t index, int threads) override {
    return ballpiston::MemoryOf(spec, PointAt(spec, index), threads);
  }
};

// A scheduler, its executor of a fake cluster, and a local one that takes turns when the test says
// so. Two of them one after the other are a server that was killed and started again.
class ClusteredServer {
 public:
  ClusteredServer(FakeSlurm& slurm, const SlurmOptions& options)
      : slurm_(slurm), executor_(scheduler_, options, slurm.Tools(options), kIdentity, [this] {
          ++flushes_;
          return flush_ok_ ? absl::OkStatus() : absl::UnavailableError("the disk is full");
        }) {}
  ~ClusteredServer() { scheduler_.Shutdown(); }

  void Start() { executor_.Start(); }

  // Its point is open.
  JournalPointer AddOpenRun(int64_t key, const EnsembleSpec& spec) {
    JournalPointer journal = AddRun(key, spec);
    OpenPoints();
    return journal;
  }
  JournalPointer AddRun(int64_t key, const EnsembleSpec& spec) {
    auto journal = std::make_shared<RecordingJournal>();
    scheduler_.Add(RunOf(key, spec, journal));
    return journal;
  }
  void OpenPoints() {
    const std::optional<Lease> lease = local_.Begin();
    ASSERT_TRUE(lease && lease->OpensPoints());
    local_.End(*lease, 0);
  }

  // Opens points whenever the cluster wants them, until it has so many arrays of one task.
  void OpenUntilSubmitted(size_t arrays) {
    size_t opened = 0, computed_here = 0;
    while (slurm_.submissions().size() < arrays) {
      const std::optional<Lease> lease = local_.Begin();
      ASSERT_TRUE(lease);
      local_.End(*lease, kAllBlocks);
      if (!lease->OpensPoints()) ++computed_here;
      opened += lease->opens.size();
      AwaitSubmissions(opened - computed_here);
    }
  }

  void AwaitSubmissions(size_t count) const {
    AwaitThat([&] { return slurm_.submissions().size() >= count; });
  }
  void AwaitProblem(const std::string& text) const {
    AwaitThat([&] { return executor_.Status().problem.find(text) != std::string::npos; });
  }
  void AwaitQueries(size_t further) const {
    const size_t now = slurm_.queries();
    AwaitThat([&] { return slurm_.queries() >= now + further; });
  }
  // The status in which the server has no task.
  SlurmStatus AwaitIdle() const {
    SlurmStatus now;
    AwaitThat([&] {
      now = executor_.Status();
      return now.waiting_tasks + now.running_tasks + now.submitted_tasks == 0;
    });
    return now;
  }

  Scheduler& scheduler() { return scheduler_; }
  SlurmExecutor& executor() { return executor_; }
  SlurmStatus Status() const { return executor_.Status(); }
  void ComputeHere() { local_.TakeAllTurns(); }
  void SetFlush(bool ok) { flush_ok_ = ok; }
  int flushes() const { return flushes_; }

 private:
  FakeSlurm& slurm_;
  CoreOpener opener_;
  Scheduler scheduler_{opener_, 1, {.least_seconds_elsewhere = 0}};
  SteppedExecutor local_{scheduler_};
  std::atomic<bool> flush_ok_ = true;
  std::atomic<int> flushes_ = 0;
  SlurmExecutor executor_;
};

class SlurmExecutorTest : public testing::Test {
 protected:
  SlurmExecutorTest() {
    std::filesystem::create_directory(shared_);
    chmod(shared_.c_str(), 0700);
    WriteFile(options_.worker, "a worker");
  }

  void StartServer() {
    server_ = std::make_unique<ClusteredServer>(slurm_, options_);
    server_->Start();
  }

  // A run with an array of so many tasks of one chunk each.
  void SubmitRun(uint64_t tasks = 3) {
    spec_ = PointOfChunks(tasks);
    StartServer();
    journal_ = server_->AddOpenRun(1, spec_);
    server_->AwaitSubmissions(1);
  }

  std::string ArrayFolder(const std::string& name) const {
    return absl::StrCat(shared_, "/", kIdentity, "/", name);
  }
  std::string NewestArray() const { return slurm_.submissions().back().name; }
  size_t NewestTasks() const { return slurm_.submissions().back().tasks; }

  void ExpectRightEnd() {
    EXPECT_OK(journal_->AwaitEnd());
    ASSERT_EQ(journal_->finished.size(), 1u);
    EXPECT_TRUE(journal_->finished.at(0) == *FoldPoint(*PointExperiment::Create(spec_, 0)));
    EXPECT_EQ(journal_->merged.at(0), *spec_.target.samples);
  }
  // Runs whatever is submitted until the run has ended.
  void RunToRightEnd() {
    AwaitThat([&] {
      slurm_.RunAll();
      std::lock_guard lock(journal_->mutex);
      return journal_->outcome.has_value();
    });
    ExpectRightEnd();
  }

  const TemporaryFolder folder_;
  const std::string shared_ = folder_.File("shared");
  SlurmOptions options_ = {.shared_folder = shared_,
                           .worker = folder_.File("worker"),
                           .task_length = std::chrono::milliseconds(1),
                           .query_interval = std::chrono::milliseconds(20),
                           .collect_interval = std::chrono::milliseconds(2)};
  FakeSlurm slurm_;
  std::unique_ptr<ClusteredServer> server_;
  EnsembleSpec spec_;
  JournalPointer journal_;
};

// ---- without faults ----

TEST_F(SlurmExecutorTest, TasksGiveTheBitsOfOnePlace) {
  SubmitRun();
  const ArraySubmission array = slurm_.submissions().at(0);
  EXPECT_EQ(array.tasks, 3u);
  EXPECT_EQ(array.folder, ArrayFolder(array.name));
  EXPECT_THAT(array.name, testing::StartsWith(absl::StrCat("bp-", kIdentity, "-")));
  EXPECT_THAT(array.command, ElementsAre(HasSubstr("/ballpiston-worker-"), "--task-file",
                                         array.folder + "/tasks", "--out", array.folder));
  EXPECT_EQ(Contents(array.command.at(0)), "a worker");
  for (const size_t task : {2, 0, 1}) EXPECT_OK(slurm_.Run(array.name, task));
  ExpectRightEnd();
  server_->AwaitIdle();
  EXPECT_THAT(slurm_.submissions(), SizeIs(1));
  const SlurmStatus status = server_->Status();
  EXPECT_EQ(status.chunks, 3);
  EXPECT_EQ(status.lost_tasks + status.refused_files, 0);
  EXPECT_EQ(status.problem, "");
}

TEST_F(SlurmExecutorTest, TheStatusSaysWhichTasksWaitAndRun) {
  SubmitRun();
  AwaitThat([&] { return server_->Status().waiting_tasks == 3; });
  slurm_.Start(NewestArray(), 1);
  AwaitThat([&] { return server_->Status().running_tasks == 1; });
  EXPECT_EQ(server_->Status().waiting_tasks, 2u);
  RunToRightEnd();
}

TEST_F(SlurmExecutorTest, AnArraysFolderStaysUntilItsChunksAreOnDisk) {
  SubmitRun();
  server_->SetFlush(false);
  const std::string folder = ArrayFolder(NewestArray());
  slurm_.RunAll();
  ExpectRightEnd();
  const int flushes = server_->flushes();
  AwaitThat([&] { return server_->flushes() > flushes + 2; });
  EXPECT_TRUE(std::filesystem::exists(folder));
  server_->SetFlush(true);
  AwaitThat([&] { return !std::filesystem::exists(folder); });
}

// ---- submission ----

TEST_F(SlurmExecutorTest, ARefusedSubmissionIsComputedHere) {
  slurm_.Answer(absl::UnavailableError("sbatch: no such partition"), false);
  SubmitRun();
  server_->AwaitProblem("no such partition");
  server_->AwaitIdle();
  AwaitThat([&] {
    server_->ComputeHere();
    std::lock_guard lock(journal_->mutex);
    return journal_->outcome.has_value();
  });
  ExpectRightEnd();
  EXPECT_EQ(server_->Status().chunks, 0);
}

TEST_F(SlurmExecutorTest, AfterARefusalOneTaskProbes) {
  slurm_.Answer(absl::UnavailableError("sbatch: no such partition"), false);
  SubmitRun();
  server_->AwaitProblem("no such partition");
  slurm_.Answer(absl::OkStatus(), true);
  AwaitThat([&] { return !slurm_.queue().empty(); });
  EXPECT_EQ(NewestTasks(), 1u);
  const size_t submissions = slurm_.submissions().size();
  server_->AwaitQueries(4);
  EXPECT_EQ(slurm_.submissions().size(), submissions) << "a second array while one probes";
  EXPECT_EQ(server_->Status().problem, "");
  EXPECT_OK(slurm_.Run(NewestArray(), 0));
  server_->AwaitSubmissions(submissions + 1);
  EXPECT_EQ(NewestTasks(), 2u) << "the rest, after the first has left its file";
  RunToRightEnd();
}

TEST_F(SlurmExecutorTest, AnUnknownSubmissionThatWorkedIsNotRepeated) {
  slurm_.Answer(absl::UnknownError("sbatch: Socket timed out"), true);
  SubmitRun();
  AwaitThat([&] { return server_->Status().waiting_tasks == 3; });
  EXPECT_THAT(server_->Status().problem, HasSubstr("timed out"));
  server_->AwaitQueries(3);
  slurm_.RunAll();
  ExpectRightEnd();
  EXPECT_THAT(slurm_.submissions(), SizeIs(1));
  EXPECT_EQ(server_->Status().lost_tasks, 0);
}

TEST_F(SlurmExecutorTest, AnUnknownSubmissionThatDidNotWorkIsRepeated) {
  slurm_.Answer(absl::UnknownError("sbatch: Socket timed out"), false);
  SubmitRun();
  slurm_.Answer(absl::OkStatus(), true);
  server_->AwaitSubmissions(2);
  EXPECT_GE(slurm_.queries(), 2u);
  EXPECT_NE(slurm_.submissions()[0].name, slurm_.submissions()[1].name);
  RunToRightEnd();
}

TEST_F(SlurmExecutorTest, ArraysShrinkUntilSlurmAcceptsThem) {
  slurm_.Answer(absl::UnavailableError("sbatch: Invalid job array specification"), false);
  options_.max_array_size = 4;
  SubmitRun(4);
  AwaitThat(
      [&] { return !slurm_.submissions().empty() && slurm_.submissions().back().tasks == 1; });
  slurm_.Answer(absl::OkStatus(), true);
  RunToRightEnd();
  EXPECT_EQ(slurm_.submissions().at(0).tasks, 4u);
  EXPECT_EQ(NewestTasks(), 1u);
}

TEST_F(SlurmExecutorTest, NoMoreTasksThanPermittedAreSubmitted) {
  options_.max_tasks = 2;
  SubmitRun(4);
  const auto tasks = [this] {
    size_t count = 0;
    for (const auto& [name, indices] : slurm_.queue()) count += indices.size();
    return count;
  };
  AwaitThat([&] { return tasks() == 2; });
  server_->AwaitQueries(3);
  EXPECT_EQ(tasks(), 2u);
  RunToRightEnd();
}

TEST_F(SlurmExecutorTest, AReasonThatLastsForEverCancelsTheArray) {
  slurm_.SetReason("PartitionTimeLimit");
  SubmitRun();
  const std::string name = NewestArray();
  server_->AwaitProblem("PartitionTimeLimit");
  AwaitThat([&] { return !slurm_.cancelled().empty(); });
  EXPECT_THAT(slurm_.cancelled(), Contains(name));
  slurm_.SetReason("Priority");
  RunToRightEnd();
}

TEST_F(SlurmExecutorTest, AReasonThatPassesKeepsTheArray) {
  slurm_.SetReason("Resources");
  SubmitRun();
  server_->AwaitQueries(4);
  EXPECT_THAT(slurm_.cancelled(), IsEmpty());
  RunToRightEnd();
}

// ---- lost tasks ----

TEST_F(SlurmExecutorTest, LostTasksAreComputedAgain) {
  SubmitRun();
  const std::string name = NewestArray();
  EXPECT_OK(slurm_.Run(name, 0));
  slurm_.LoseAll();
  server_->AwaitSubmissions(2);
  EXPECT_EQ(server_->Status().lost_tasks, 2);
  ASSERT_OK_AND_ASSIGN(const ArrayTask again, TaskIn(slurm_.submissions()[1].folder, 0));
  EXPECT_EQ(again.leases.at(0).lease.attempt, 2);
  RunToRightEnd();
  EXPECT_EQ(server_->Status().chunks, 3);
}

// Its marks show that the task can use the folder, so other leases are submitted as before.
TEST_F(SlurmExecutorTest, ThreeCrashesOfALeaseFailItsRunAlone) {
  StartServer();
  spec_ = PointOfChunks(1);
  journal_ = server_->AddOpenRun(1, spec_);
  for (size_t attempt = 1; attempt <= 3; ++attempt) {
    server_->AwaitSubmissions(attempt);
    const ArraySubmission array = slurm_.submissions().back();
    ASSERT_OK_AND_ASSIGN(const ArrayTask task, TaskIn(array.folder, 0));
    EXPECT_EQ(task.leases.at(0).lease.crashes, static_cast<int>(attempt) - 1);
    WriteFile(CrashMarkFile(array.folder, 0, 0), "");
    slurm_.LoseAll();
  }
  EXPECT_THAT(journal_->AwaitEnd(),
              StatusIs(absl::StatusCode::kInternal, HasSubstr("the engine crashed 3 times")));
  EXPECT_THAT(server_->AwaitIdle().problem, IsEmpty());
  journal_ = server_->AddOpenRun(2, spec_);
  RunToRightEnd();
}

// Lost tasks are no crashes: after some attempts this server computes the chunk.
TEST_F(SlurmExecutorTest, TheCrashesOfALeaseSurviveARestart) {
  SubmitRun(1);
  WriteFile(CrashMarkFile(slurm_.submissions().back().folder, 0, 0), "");
  slurm_.LoseAll();
  server_->AwaitSubmissions(2);
  server_ = nullptr;
  server_ = std::make_unique<ClusteredServer>(slurm_, options_);
  journal_ = server_->AddRun(1, spec_);
  server_->Start();
  server_->OpenPoints();
  slurm_.LoseAll();
  server_->AwaitProblem("left no file");
  AwaitThat([&] { return slurm_.submissions().size() >= 3; });
  ASSERT_OK_AND_ASSIGN(const ArrayTask task, TaskIn(slurm_.submissions().back().folder, 0));
  EXPECT_EQ(task.leases.at(0).lease.crashes, 1);
  EXPECT_EQ(task.leases.at(0).lease.attempt, 3);
  RunToRightEnd();
}

// It leaves its leases out and says why; later leases of as much memory stay here.
TEST_F(SlurmExecutorTest, AQuestionBeyondTheMemoryOfANodeIsComputedHere) {
  slurm_.SetMemory(1e6);
  SubmitRun();
  AwaitThat([&] {
    slurm_.RunAll();
    server_->ComputeHere();
    std::lock_guard lock(journal_->mutex);
    return journal_->outcome.has_value();
  });
  ExpectRightEnd();
  server_->AwaitIdle();
  EXPECT_THAT(slurm_.submissions(), SizeIs(1));
  EXPECT_EQ(server_->Status().chunks + server_->Status().lost_tasks, 0);
  EXPECT_EQ(server_->Status().problem, "");
}

// A task is not lost because one answer of Slurm lacks it: a file may become visible later.
TEST_F(SlurmExecutorTest, ATaskIsLostAfterTwoQueriesWithoutIt) {
  SubmitRun(2);
  server_->AwaitQueries(1);
  const size_t before = slurm_.Lose(NewestArray(), 0);
  AwaitThat([&] { return server_->Status().lost_tasks > 0; });
  EXPECT_GE(slurm_.queries(), before + 2);
}

TEST_F(SlurmExecutorTest, TasksThatLeaveNoFileAreAProblem) {
  SubmitRun();
  slurm_.LoseAll();
  server_->AwaitProblem("left no file");
  EXPECT_EQ(server_->Status().lost_tasks, 3);
  AwaitThat([&] { return !slurm_.queue().empty(); });
  EXPECT_EQ(NewestTasks(), 1u);
  RunToRightEnd();
  AwaitThat([&] { return server_->Status().problem.empty(); });
}

// The first attempt goes on, although Slurm reported it as ended, and both attempts leave files.
TEST_F(SlurmExecutorTest, AChunkThatIsComputedTwiceCountsOnce) {
  SubmitRun();
  const ArraySubmission first = slurm_.submissions().at(0);
  ASSERT_OK_AND_ASSIGN(const ArrayTask task, TaskIn(first.folder, 0));
  slurm_.Lose(first.name, 0);
  server_->AwaitProblem("left no file");
  EXPECT_OK(slurm_.Run(first.name, 1));  // so the cluster works, and the lost task is submitted
  server_->AwaitSubmissions(2);
  EXPECT_OK(RunTask(task, {.folder = first.folder}, std::stop_source(), [](absl::string_view) {}));
  RunToRightEnd();
}

// If Slurm does not answer, the tasks do not count as lost.
TEST_F(SlurmExecutorTest, NothingIsLostWhileSlurmDoesNotAnswer) {
  SubmitRun();
  slurm_.AnswerQuery(absl::UnavailableError("squeue: Unable to contact slurm controller"));
  server_->AwaitProblem("Unable to contact slurm controller");
  server_->AwaitQueries(4);
  EXPECT_EQ(server_->Status().lost_tasks, 0);
  EXPECT_OK(slurm_.Run(NewestArray(), 0));
  AwaitThat([&] { return server_->Status().chunks == 1; });
  slurm_.AnswerQuery(absl::OkStatus());
  AwaitThat([&] { return server_->Status().problem.empty(); });
  RunToRightEnd();
  EXPECT_THAT(slurm_.submissions(), SizeIs(1));
}

// ---- files that are refused ----

struct BadFile {
  std::string name;
  // Writes files of task 0 into `folder`.
  std::function<void(ArrayTask task, const std::string& folder)> write;
  std::string reason;  // in the log
};

void RunInto(const ArrayTask& task, const std::string& folder) {
  EXPECT_OK(RunTask(task, {.folder = folder}, std::stop_source(), [](absl::string_view) {}));
}

// Runs the task elsewhere and copies its file with changed bytes.
void WriteChanged(const ArrayTask& task, const std::string& folder,
                  const std::function<void(std::string&)>& change) {
  const TemporaryFolder elsewhere;
  RunInto(task, elsewhere.path());
  const std::string name = ChunkFileName{task.task, 0}.Text();
  std::string bytes = Contents(elsewhere.File(name));
  change(bytes);
  WriteFile(elsewhere.File("changed"), bytes);
  chmod(elsewhere.File("changed").c_str(), 0600);
  std::filesystem::copy_file(elsewhere.File("changed"), absl::StrCat(folder, "/.new"));
  std::filesystem::rename(absl::StrCat(folder, "/.new"), absl::StrCat(folder, "/", name));
}

const BadFile kBadFiles[] = {
    {"Empty",
     [](const ArrayTask& task, const std::string& folder) {
       WriteChanged(task, folder, [](std::string& bytes) { bytes.clear(); });
     },
     "chunk file is refused"},
    {"Truncated",
     [](const ArrayTask& task, const std::string& folder) {
       WriteChanged(task, folder, [](std::string& bytes) { bytes.pop_back(); });
     },
     "truncated"},
    {"Corrupted",
     [](const ArrayTask& task, const std::string& folder) {
       WriteChanged(task, folder, [](std::string& bytes) { bytes[bytes.size() / 2] ^= 1; });
     },
     "corrupted"},
    {"OfAnotherArray",
     [](ArrayTask task, const std::string& folder) {
       task.array = "bp-server1-other";
       RunInto(task, folder);
     },
     "is of array bp-server1-other"},
    {"OfAnotherServer",
     [](ArrayTask task, const std::string& folder) {
       task.leases.at(0).job.server = "another";
       RunInto(task, folder);
     },
     "not the job of the lease"},
    {"OfAnEarlierEngine",
     [](ArrayTask task, const std::string& folder) {
       task.leases.at(0).job.engine_version = "0.0.1";
       RunInto(task, folder);
     },
     "not the job of the lease"},
    {"OfTheJobBeforeItsRestart",
     [](ArrayTask task, const std::string& folder) {
       task.leases.at(0).job.generation -= 1;
       RunInto(task, folder);
     },
     "not the job of the lease"},
    {"OfAnotherPoint",
     [](ArrayTask task, const std::string& folder) {
       task.leases.at(0).lease.point += 1;
       RunInto(task, folder);
     },
     "not the point of the lease"},
    {"WithAChunkMore",
     [](ArrayTask task, const std::string& folder) {
       task.leases.at(0).lease.end += 1;
       RunInto(task, folder);
     },
     "not in the lease"},
    {"WithALeaseMore",
     [](ArrayTask task, const std::string& folder) {
       task.leases.push_back(task.leases.at(0));
       RunInto(task, folder);
     },
     "a lease that its task has not"},
};

class SlurmBadFileTest : public SlurmExecutorTest, public testing::WithParamInterface<BadFile> {};

TEST_P(SlurmBadFileTest, IsRefusedLoggedCountedAndComputedAgain) {
  testing::internal::CaptureStderr();
  SubmitRun();
  const ArraySubmission array = slurm_.submissions().at(0);
  ASSERT_OK_AND_ASSIGN(const ArrayTask task, TaskIn(array.folder, 0));
  GetParam().write(task, array.folder);
  AwaitThat([&] { return server_->Status().refused_files > 0; });
  EXPECT_EQ(server_->Status().refused_files, 1);
  EXPECT_EQ(server_->Status().chunks, 0);
  slurm_.Lose(array.name, 0);
  AwaitThat([&] { return server_->Status().lost_tasks == 1; });
  RunToRightEnd();
  server_.reset();
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_THAT(log, AllOf(HasSubstr("chunk file is refused"), HasSubstr(GetParam().reason)));
}

INSTANTIATE_TEST_SUITE_P(SlurmExecutor, SlurmBadFileTest, testing::ValuesIn(kBadFiles),
                         [](const auto& param) { return param.param.name; });

TEST_F(SlurmExecutorTest, OtherFilesAreIgnored) {
  SubmitRun();
  const std::string folder = ArrayFolder(NewestArray());
  for (const std::string name : {"0.log", "task-0.0.chunks.tmp", "task-x.0.chunks", ".nfs01"}) {
    WriteFile(folder + "/" + name, "something");
  }
  RunToRightEnd();
  EXPECT_EQ(server_->Status().refused_files, 0);
}

// ---- the shared folder ----

TEST_F(SlurmExecutorTest, AFolderThatIsUnusableAtTheStartIsUsedLater) {
  chmod(shared_.c_str(), 0777);
  StartServer();
  server_->AwaitProblem("can be written by other users");
  spec_ = PointOfChunks(3);
  journal_ = server_->AddOpenRun(1, spec_);
  chmod(shared_.c_str(), 0700);
  RunToRightEnd();
  AwaitThat([&] { return server_->Status().problem.empty(); });
}

TEST_F(SlurmExecutorTest, NothingIsSubmittedWhileTheFolderIsUnusable) {
  StartServer();
  chmod(shared_.c_str(), 0777);
  spec_ = PointOfChunks(3);
  journal_ = server_->AddOpenRun(1, spec_);
  server_->AwaitProblem("can be written by other users");
  EXPECT_THAT(slurm_.submissions(), IsEmpty());
  chmod(shared_.c_str(), 0700);
  RunToRightEnd();
  AwaitThat([&] { return server_->Status().problem.empty(); });
}

TEST_F(SlurmExecutorTest, AMissingWorkerIsAProblem) {
  std::filesystem::remove(options_.worker);
  StartServer();
  spec_ = PointOfChunks(3);
  journal_ = server_->AddOpenRun(1, spec_);
  server_->AwaitProblem(options_.worker);
  WriteFile(options_.worker, "a worker");
  RunToRightEnd();
}

// ---- cancellation ----

TEST_F(SlurmExecutorTest, ACancelledRunIsCancelledInTheCluster) {
  SubmitRun();
  const std::string name = NewestArray();
  server_->scheduler().Cancel(1);
  EXPECT_THAT(journal_->AwaitEnd(), StatusIs(absl::StatusCode::kCancelled));
  AwaitThat([&] { return !slurm_.cancelled().empty(); });
  EXPECT_THAT(slurm_.cancelled(), Contains(name));
  EXPECT_THAT(slurm_.queue(), IsEmpty());
  server_->AwaitIdle();
  AwaitThat([&] { return !std::filesystem::exists(ArrayFolder(name)); });
}

TEST_F(SlurmExecutorTest, OnlyTheArraysOfTheCancelledRunAreCancelled) {
  SubmitRun();
  const std::string first = NewestArray();
  spec_ = PointOfChunks(2);
  const JournalPointer other = std::exchange(journal_, server_->AddOpenRun(2, spec_));
  server_->AwaitSubmissions(2);
  server_->scheduler().Cancel(1);
  EXPECT_THAT(other->AwaitEnd(), StatusIs(absl::StatusCode::kCancelled));
  AwaitThat([&] { return !slurm_.cancelled().empty(); });
  // Before the end of the other run, at which its last tasks may be cancelled too.
  EXPECT_THAT(slurm_.cancelled(), ElementsAre(first));
  RunToRightEnd();
}

// ---- several servers ----

TEST_F(SlurmExecutorTest, OrphansOfThisServerAloneAreCancelled) {
  const std::string orphan = absl::StrCat("bp-", kIdentity, "-orphan");
  const std::string foreign = absl::StrCat("bp-", kIdentity, "2-array");
  slurm_.Add(orphan, 2);
  slurm_.Add(foreign, 2);
  slurm_.Add("bp-another-array", 2);
  slurm_.Add("simulation", 1);
  SubmitRun();
  AwaitThat([&] { return !slurm_.queue().contains(orphan); });
  server_->AwaitQueries(3);
  EXPECT_THAT(slurm_.cancelled(), ElementsAre(orphan));
  EXPECT_EQ(slurm_.queue().size(), 4u);
}

// The server ends while tasks wait and run; its successor takes their files.
TEST_F(SlurmExecutorTest, ALaterServerAdoptsTheTasks) {
  SubmitRun();
  const std::string name = NewestArray();
  server_.reset();
  EXPECT_THAT(slurm_.cancelled(), IsEmpty());
  EXPECT_OK(slurm_.Run(name, 1));
  slurm_.Start(name, 0);
  server_ = std::make_unique<ClusteredServer>(slurm_, options_);
  journal_ = server_->AddRun(1, spec_);
  server_->Start();
  server_->OpenPoints();
  AwaitThat([&] { return server_->Status().chunks == 1; });
  server_->AwaitQueries(3);
  EXPECT_THAT(slurm_.submissions(), SizeIs(1)) << "leased again";
  EXPECT_THAT(slurm_.cancelled(), IsEmpty());
  slurm_.RunAll();
  ExpectRightEnd();
  EXPECT_THAT(slurm_.submissions(), SizeIs(1));
  AwaitThat([&] { return !std::filesystem::exists(ArrayFolder(name)); });
}

TEST_F(SlurmExecutorTest, AdoptedTasksThatAreLostAreComputedAgain) {
  SubmitRun();
  server_.reset();
  slurm_.LoseAll();
  server_ = std::make_unique<ClusteredServer>(slurm_, options_);
  journal_ = server_->AddRun(1, spec_);
  server_->Start();
  server_->OpenPoints();
  server_->AwaitSubmissions(2);
  RunToRightEnd();
}

TEST_F(SlurmExecutorTest, TheTasksOfAJobThatHasEndedAreCancelled) {
  SubmitRun();
  const std::string name = NewestArray();
  server_.reset();
  StartServer();
  AwaitThat([&] { return !slurm_.cancelled().empty(); });
  EXPECT_THAT(slurm_.cancelled(), Contains(name));
  AwaitThat([&] { return !std::filesystem::exists(ArrayFolder(name)); });
}

TEST_F(SlurmExecutorTest, AnArrayWithADamagedTaskFileIsCancelledAndComputedAgain) {
  SubmitRun();
  const std::string name = NewestArray();
  server_.reset();
  WriteFile(ArrayFolder(name) + "/tasks", "damaged");
  server_ = std::make_unique<ClusteredServer>(slurm_, options_);
  journal_ = server_->AddRun(1, spec_);
  server_->Start();
  server_->OpenPoints();
  AwaitThat([&] { return !slurm_.cancelled().empty(); });
  EXPECT_THAT(slurm_.cancelled(), Contains(name));
  RunToRightEnd();
  AwaitThat([&] { return !std::filesystem::exists(ArrayFolder(name)); });
}

// ---- queries ----

class SlurmQueriesTest : public SlurmExecutorTest, public testing::WithParamInterface<int> {};

TEST_P(SlurmQueriesTest, ThereIsAtMostOneInAnInterval) {
  const auto arrays = static_cast<size_t>(GetParam());
  options_.query_interval = std::chrono::milliseconds(50);
  options_.max_array_size = 1;
  options_.max_tasks = 2 * arrays;
  const auto start = std::chrono::steady_clock::now();
  StartServer();
  EnsembleSpec spec = PointOfChunks(1);
  spec.grid[kDelta].clear();
  for (size_t i = 0; i < 2 * arrays; ++i) {
    spec.grid[kDelta].push_back(0.1 + 1e-5 * static_cast<double>(i));
  }
  journal_ = server_->AddRun(1, spec);
  server_->OpenUntilSubmitted(arrays);
  server_->AwaitQueries(4);
  const size_t queries = slurm_.queries();
  const auto intervals = (std::chrono::steady_clock::now() - start) / options_.query_interval;
  EXPECT_LE(queries, static_cast<size_t>(intervals) + 1);
  EXPECT_GE(slurm_.queue().size(), arrays);
}

INSTANTIATE_TEST_SUITE_P(SlurmExecutor, SlurmQueriesTest, testing::Values(1, 250));

// The thread that submits the second run's tasks looks first whether a query is due, and here it
// always is.
TEST_F(SlurmExecutorTest, SlurmIsQueriedOnlyWhileThereAreTasks) {
  options_.query_interval = std::chrono::milliseconds(0);
  StartServer();
  spec_ = PointOfChunks(1);
  journal_ = server_->AddOpenRun(1, spec_);
  RunToRightEnd();
  const SlurmStatus idle = server_->AwaitIdle();
  server_->AddOpenRun(2, spec_);
  server_->AwaitSubmissions(2);
  EXPECT_EQ(slurm_.QueriesBeforeSubmission(1), static_cast<size_t>(idle.queries));
}

}  // namespace
}  // namespace ballpiston::server
