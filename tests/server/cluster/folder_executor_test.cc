// The executor of a shared folder, step by step: the test looks, and does the workers' part.
#include "server/cluster/folder_executor.h"

#include "server/compute/crash_record.h"
#include "server/worker/worker.h"
#include "tests/server/compute/stepped_scheduler.h"
#include "tests/server/preamble.h"
#include "tests/server/worker/fake_files.h"
#include "tests/server/worker/sample_leases.h"

namespace ballpiston::server {
namespace {

using std::chrono::milliseconds;

class FolderExecutorTest : public testing::Test {
 protected:
  FolderExecutorTest() { Restart(); }

  // A new process of the server, with the same folder.
  void Restart(ClusterOptions options = {.look = milliseconds(0), .least_waiting = 2}) {
    executor_.reset();
    stepped_.emplace(
        [](const EnsembleSpec& spec, size_t point) { return PointExperiment::Create(spec, point); },
        SchedulerOptions{.least_seconds_elsewhere = 0});
    options.lease = milliseconds(0);  // one chunk
    executor_ = std::make_unique<FolderExecutor>(
        stepped_->scheduler_, options, std::make_unique<FakeFiles>(files_),
        FolderExecutor::Server{.identity = "me",
                               .flush = [this] { return flush_; },
                               .prepare = [this] { return prepare_; }});
  }

  JournalPointer Add() { return stepped_->Add(1, spec_); }
  JournalPointer Begin() {
    JournalPointer journal = stepped_->Opened(1, spec_);
    executor_->Look();
    return journal;
  }

  std::vector<std::string> In(const std::string& subfolder) const {
    return *FakeFiles(files_).List(subfolder);
  }

  // A worker takes the lease. Its file in taken/, without the folder.
  std::string Take(const std::string& lease) {
    EXPECT_OK(files_.Move("todo/" + lease, "taken/" + lease + ".w"));
    return lease + ".w";
  }
  std::string Take() { return Take(In("todo")[0]); }
  // Takes the first lease and computes it.
  std::string Finished() {
    const std::string taken = Take();
    Compute(taken);
    End(taken);
    return taken;
  }

  Lease LeaseIn(const std::string& path) const {
    absl::string_view bytes = files_.files.at(path).bytes;
    return TakeLease(bytes).value().lease;
  }

  // The worker appends a message with the lease's chunks, or with the first one after them.
  void Compute(const std::string& taken, bool beyond = false) {
    Lease lease = LeaseIn("taken/" + taken);
    if (beyond) lease.start = {.chunk = lease.end++};
    const LeaseReport report = {.chunks = ComputedChunks(lease), .seconds = 1};
    EXPECT_OK(files_.Append("taken/" + taken, BytesOf(report)));
  }

  void End(const std::string& taken, const std::string& outcome = "finished") {
    EXPECT_OK(files_.Move("taken/" + taken, absl::StrCat("done/", taken, ".", outcome)));
  }

  // Real workers compute what is left.
  void ComputeAll(RecordingJournal& journal) {
    WorkerHost host = {.now = [] { return std::chrono::steady_clock::time_point(); },
                       .sleep = [](auto) {},
                       .random_bits = [] { return 1; },
                       .end = [] { return EndOfWork::kNotYet; },
                       .report = [](absl::string_view) {},
                       .lease_begins = [](const std::string&, const std::string&) {}};
    for (int round = 0; round < 50 && !journal.outcome; ++round) {
      EXPECT_OK(Work(files_, {.name = "real", .idle_seconds = 0}, host));
      executor_->Look();
    }
    ASSERT_TRUE(journal.outcome);
    EXPECT_OK(*journal.outcome);
    const auto experiment = PointExperiment::Create(spec_, 0);
    EXPECT_TRUE(journal.finished.at(0) == FoldPoint(*experiment));
    EXPECT_EQ(journal.merged.at(0), experiment->plan().samples());
  }

  // One point of six chunks and more. A lease has one.
  EnsembleSpec spec_ = SpecOf(kFirstHit, Model::kBilliard, 100'000);
  FakeFiles files_;
  absl::Status flush_, prepare_;
  std::optional<SteppedScheduler> stepped_;
  std::unique_ptr<FolderExecutor> executor_;
};

TEST_F(FolderExecutorTest, LeasesThatAKilledServerWasWritingOrHasLaidAreRemoved) {
  files_.files[kLeaseBeingWritten] = files_.files["todo/earlier-1"] = {};
  Begin();
  EXPECT_FALSE(files_.files.contains(kLeaseBeingWritten));
  EXPECT_FALSE(files_.files.contains("todo/earlier-1"));
  EXPECT_THAT(In("todo"), SizeIs(2));
}

TEST_F(FolderExecutorTest, AFileWhosePointIsNotOpenIsReadAgainAfterAPause) {
  Begin();
  Finished();
  Restart({.look = std::chrono::hours(1)});
  Add();
  int reads = 0;
  files_.Before("read", [&] {
    ++reads;
    return absl::OkStatus();
  });
  for (int look = 0; look < 5; ++look) executor_->Look();
  EXPECT_EQ(reads, 1);
}

TEST_F(FolderExecutorTest, AFolderThatDoesNotAnswerIsAProblem) {
  std::string soon, late;
  files_.before = [&](const char*, const std::string&) {
    soon = executor_->Status(SteadyNow() + std::chrono::seconds(20)).problem;
    late = executor_->Status(SteadyNow() + std::chrono::seconds(40)).problem;
    return absl::OkStatus();
  };
  executor_->Look();
  EXPECT_EQ(soon, "");
  EXPECT_THAT(late, HasSubstr("slowly or not at all"));
  EXPECT_EQ(executor_->Status(SteadyNow() + std::chrono::seconds(40)).problem, "");
}

// The file in taken/ is moved away, so that its worker stops. The later process looks before it
// opens the point, and again while it opens it.
TEST_F(FolderExecutorTest, AFileOfAnEarlierProcessIsReported) {
  Begin();
  const std::string taken = Take();
  Compute(taken);
  Restart();
  const auto journal = Add();
  executor_->Look();
  executor_->Look();
  EXPECT_THAT(In("taken"), IsEmpty());
  EXPECT_THAT(In("done"), ElementsAre(taken + ".lost"));
  const std::optional<Lease> opening = stepped_->Begin();
  executor_->Look();
  EXPECT_THAT(In("done"), ElementsAre(taken + ".lost"));
  stepped_->End(*opening, 0);
  executor_->Look();
  EXPECT_THAT(In("done"), IsEmpty());
  EXPECT_EQ(executor_->Status().chunks, 1);
  ComputeAll(*journal);
}

// It stays while the disk fails, and while it cannot be removed.
TEST_F(FolderExecutorTest, AFileOfAnEarlierProcessIsReportedAndChargedOnce) {
  Begin();
  const std::string taken = Finished();
  Restart();
  flush_ = absl::UnavailableError("the disk is slow");
  const auto journal = Begin();
  executor_->Look();
  EXPECT_EQ(executor_->Status().problem, "the disk is slow");
  flush_ = absl::OkStatus();
  files_.Before("remove", [] { return absl::UnavailableError("slow, too"); });
  executor_->Look();
  executor_->Look();
  EXPECT_THAT(In("done"), ElementsAre(taken + ".finished"));
  files_.before = nullptr;
  executor_->Look();
  EXPECT_THAT(In("done"), IsEmpty());
  EXPECT_EQ(executor_->Status().problem, "");
  EXPECT_EQ(executor_->Status().chunks, 1);
  EXPECT_EQ(journal->work, 1);
  EXPECT_EQ(stepped_->scheduler_.processor_seconds(), 1);
  ComputeAll(*journal);
}

// Each of these leases is taken and ends between two looks.
TEST_F(FolderExecutorTest, ACrashOfTheEngineIsCounted) {
  const auto journal = Begin();
  for (int death = 0; death < kMostDeaths; ++death) {
    ASSERT_FALSE(journal->outcome);
    std::string crashing;
    for (const std::string& name : In("todo")) {
      if (LeaseIn("todo/" + name).start.chunk == 0) crashing = name;
    }
    ASSERT_NE(crashing, "");
    End(Take(crashing), "crashed");
    executor_->Look();
  }
  ASSERT_TRUE(journal->outcome);
  EXPECT_THAT(*journal->outcome, StatusIs(absl::StatusCode::kInternal));
  EXPECT_EQ(executor_->Status().claims, kMostDeaths);
}

TEST_F(FolderExecutorTest, DamagedFilesAreRefusedAndComputedAgain) {
  const auto journal = Begin();
  const std::string taken = Take();
  Compute(taken);
  files_.files["taken/" + taken].bytes.back() ^= 1;
  End(taken);
  files_.files["done/another-1.w.finished"].bytes = FileOf(LeaseIn("todo/" + In("todo")[0]));
  const std::string beyond = Take();
  Compute(beyond, true);
  End(beyond);
  files_.files["done/unknown.w.finished"].bytes = "a foreign file of some length, of no server";
  files_.files["done/foreign"] = {};  // is left alone
  executor_->Look();
  EXPECT_EQ(executor_->Status().refused_files, 4);
  EXPECT_THAT(In("done"), ElementsAre("foreign"));
  ComputeAll(*journal);
}

// ---- time-outs: of 0 s, so every look is late ----

const ClusterOptions kNoTimeOut = {
    .timeout = milliseconds(0), .look = milliseconds(0), .least_waiting = 2};

TEST_F(FolderExecutorTest, ASilentWorkerLosesItsLease) {
  Restart(kNoTimeOut);
  const auto journal = Begin();
  const std::string taken = Take();
  executor_->Look();
  EXPECT_THAT(In("done"), ElementsAre(taken + ".lost"));
  executor_->Look();
  EXPECT_EQ(executor_->Status().lost_leases, 1);
  ComputeAll(*journal);
}

TEST_F(FolderExecutorTest, WhileThereIsNoWorkerTheThreadsComputeAndOneLeaseWaits) {
  Restart(kNoTimeOut);
  Begin();
  EXPECT_THAT(In("todo"), SizeIs(2));
  executor_->Look();
  EXPECT_THAT(In("todo"), SizeIs(1));
  Take();
  executor_->Look();
  EXPECT_THAT(In("todo"), SizeIs(2));
}

TEST_F(FolderExecutorTest, ThreadsCanTakeReturnedLeasesFirst) {
  Restart({.timeout = milliseconds(0), .look = std::chrono::hours(1), .least_waiting = 2});
  const auto journal = Begin();
  executor_->Look();
  executor_->Look();
  EXPECT_THAT(In("todo"), IsEmpty());
  EXPECT_EQ(executor_->Status().waiting_leases, 1);  // or Slurm's workers would be cancelled
  stepped_->TakeAllTurns();
  ASSERT_TRUE(journal->outcome);
  EXPECT_OK(*journal->outcome);
}

TEST_F(FolderExecutorTest, AFolderThatCannotBeUsedGivesItsLeasesBack) {
  Restart(kNoTimeOut);
  Begin();
  Take();
  executor_->Look();
  prepare_ = absl::FailedPreconditionError("can be written by other users");
  files_.before = [](const char*, const std::string&) { return absl::UnavailableError("gone"); };
  executor_->Look();
  executor_->Look();
  EXPECT_EQ(executor_->Status().problem, "can be written by other users");
  EXPECT_EQ(executor_->Status().waiting_leases + executor_->Status().taken_leases, 0);
}

// The pauses double from a second to a minute: the 10th attempt comes after 4 minutes.
TEST_F(FolderExecutorTest, AFullFolderIsTriedAgainAfterAPause) {
  int attempts = 0;
  files_.Before("create", [&] {
    ++attempts;
    return absl::UnavailableError("full");
  });
  Begin();
  for (int look = 0; look < 100; ++look) executor_->Look();
  EXPECT_GE(attempts, 1);
  EXPECT_LE(attempts, 10);
  EXPECT_EQ(executor_->Status().problem, "full");
}

TEST_F(FolderExecutorTest, ALeaseThatCannotBeMovedLeavesNoFile) {
  files_.Before("move", [] { return absl::ResourceExhaustedError("full"); });
  Begin();
  EXPECT_EQ(executor_->Status().problem, "full");
  EXPECT_THAT(files_.files, IsEmpty());
}

TEST_F(FolderExecutorTest, ALeaseGoesBackIfMemoryRunsOutWhileItIsLaid) {
  bool has_failed = false;
  files_.Before("create", [&] {
    if (!std::exchange(has_failed, true)) throw std::bad_alloc();
    return absl::OkStatus();
  });
  const auto journal = Begin();
  EXPECT_NE(executor_->Status().problem, "");
  executor_->Look();
  EXPECT_EQ(executor_->Status().problem, "");
  ComputeAll(*journal);
}

// A lease has the states from which its trajectories continue.
TEST_F(FolderExecutorTest, LeasesContinueTheTrajectoriesOfASteadyState) {
  for (const Model model : kGasConduction.models()) {
    SCOPED_TRACE(Name(model));
    Restart();
    spec_ = SpecOf(kGasConduction, model, 600);
    ComputeAll(*Begin());
  }
}

// ---- many workers ----

// PaceOf assumes this number for the server and the worker together. Listings of taken/ and done/
// serve all leases, so they are not counted.
TEST_F(FolderExecutorTest, ALeaseTakesAtMostTenOperations) {
  double leases = 0, operations = 0;
  files_.before = [&](const std::string& operation, const std::string& path) {
    leases += operation == "create";
    operations += operation != "list" || path == "todo";
    return absl::OkStatus();
  };
  ComputeAll(*Begin());
  --operations;  // the server lists todo/ once
  EXPECT_GE(leases, 4);
  EXPECT_GT(operations, 9 * leases);
  EXPECT_LE(operations, 10 * leases);
}

TEST(Pace, ManyWorkersMakeAtMostAHundredOperationsASecond) {
  const ClusterOptions options;
  for (const size_t workers : {1, 100, 600, 601, 2000, 10'000, 50'000}) {
    const Pace pace = PaceOf(options, workers);
    const double touches = pace.touch >= pace.lease ? 0 : 2 / pace.touch;
    const double operations = static_cast<double>(workers) * (10 / pace.lease + touches);
    EXPECT_LE(operations, 101) << workers;
    EXPECT_GT(pace.timeout, pace.touch);
  }
  EXPECT_EQ(PaceOf(options, 1).touch, 20);
  EXPECT_EQ(PaceOf(options, 1).timeout, 120);
  EXPECT_NEAR(PaceOf(options, 10'000).lease, 1000, 1e-9);
  EXPECT_NEAR(PaceOf(options, 10'000).timeout, 1000 * 4.0 / 3, 1e-9);
}

}  // namespace
}  // namespace ballpiston::server
