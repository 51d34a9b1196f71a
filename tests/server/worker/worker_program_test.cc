// The program ballpiston-worker.
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/engine_version.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "core/gas/gas_shape.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/worker/chunk_file.h"
#include "server/worker/crash_mark.h"
#include "server/worker/task_file.h"
#include "tests/server/worker/sample_leases.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Leases = std::vector<IdentifiedLease>;

std::string WorkerProgram() { return BuildPath("bin/ballpiston-worker"); }

// An array of tasks, and the folder for its results.
class WorkerProgramTest : public testing::Test {
 protected:
  WorkerProgramTest() { std::filesystem::create_directory(out_); }

  void WriteTasks(const std::vector<Leases>& tasks) {
    ASSERT_OK(WriteTaskFile(task_file_, "an array", tasks));
  }

  ProcessOptions Command(std::vector<std::string> further = {}, size_t task = 0) const {
    ProcessOptions options = {.command = {WorkerProgram(), "--task-file", task_file_, "--task",
                                          absl::StrCat(task), "--out", out_}};
    options.command.insert(options.command.end(), further.begin(), further.end());
    return options;
  }

  std::vector<ChunkFile> Files() const {
    std::vector<ChunkFile> files;
    const std::vector<ChunkFileName> names = ListChunkFiles(out_).value();
    for (const ChunkFileName& name : names) {
      files.push_back(ReadChunkFile(out_, name).value());
    }
    return files;
  }

  // Of all files, in the order in which they were written.
  std::vector<ChunkResult> ChunksOfLease(size_t lease) const {
    std::vector<ChunkResult> chunks;
    const std::vector<ChunkFile> files = Files();
    for (const ChunkFile& file : files) {
      const std::vector<ChunkResult>& some = file.leases.at(lease).chunks;
      chunks.insert(chunks.end(), some.begin(), some.end());
    }
    return chunks;
  }

  const TemporaryFolder folder_;
  const std::string task_file_ = folder_.File("tasks");
  const std::string out_ = folder_.File("out");
};

TEST_F(WorkerProgramTest, GivesTheBitsOfEveryExperiment) {
  std::vector<Leases> tasks;
  for (const EnsembleSpec& spec : EverySampledSpec()) tasks.push_back({LeaseOf(spec)});
  WriteTasks(tasks);
  for (size_t i = 0; i < tasks.size(); ++i) {
    ASSERT_THAT(RunProgram(Command({}, i)), ExitsWith(0));
    ASSERT_OK_AND_ASSIGN(const ChunkFile file, ReadChunkFile(out_, {i, 0}));
    EXPECT_TRUE(file.is_final);
    EXPECT_EQ(file.array, "an array");
    ASSERT_EQ(file.leases.size(), 1u);
    EXPECT_OK(CheckLeaseChunks(tasks[i][0], file.leases[0]));
    EXPECT_EQ(file.leases[0].attempt, 2);
    EXPECT_GT(file.leases[0].processor_seconds, 0);
    EXPECT_TRUE(AreEqual(file.leases[0].chunks, AllChunks(*tasks[i][0].lease.experiment)))
        << NameOf(*tasks[i][0].lease.spec);
  }
}

TEST_F(WorkerProgramTest, ATaskHasSeveralLeases) {
  const IdentifiedLease a = LeaseOf(SpecOf(kFirstHit, Model::kBilliard, 100'000), 1, 3);
  const IdentifiedLease b = LeaseOf(SpecOf(kEquilibrium, Model::kBilliard));
  WriteTasks({{a, b}});
  ASSERT_THAT(RunProgram(Command({"--flush-seconds", "0"})), ExitsWith(0));
  const std::vector<ChunkResult> all = AllChunks(*a.lease.experiment);
  EXPECT_TRUE(AreEqual(ChunksOfLease(0), {all[1], all[2]}));
  EXPECT_TRUE(AreEqual(ChunksOfLease(1), AllChunks(*b.lease.experiment)));
  const std::vector<ChunkFile> files = Files();
  for (const ChunkFile& file : files) EXPECT_EQ(file.is_final, &file == &files.back());
}

TEST_F(WorkerProgramTest, ACrashLeavesTheMarkOfItsLease) {
  EnsembleSpec crash = SpecOf(kEquilibrium, Model::kBilliard);
  crash.seed = 13;
  WriteTasks({{LeaseOf(SpecOf(kFirstHit, Model::kBilliard)), LeaseOf(crash)}});
  ProcessOptions command = Command();
  command.environment["BALLPISTON_FAILPOINT"] = "crash-for-seed:13";
  // A sanitizer reports the signal and exits with a code of its own.
  EXPECT_THAT(RunProgram(command), testing::Not(ExitsWith(0)));
  EXPECT_FALSE(std::filesystem::exists(CrashMarkFile(out_, 0, 0)));
  EXPECT_TRUE(std::filesystem::exists(CrashMarkFile(out_, 0, 1)));
  EXPECT_THAT(RunProgram(Command()), ExitsWith(0));
}

// Slurm says MiB. Lanes of a gas of 1000 x 1000 cells take some 700 MB.
TEST_F(WorkerProgramTest, ALeaseThatNeedsMoreMemoryThanTheTaskHasIsLeftOut) {
  EnsembleSpec gas = SpecOf(kGasEquilibrium, Model::kBilliard, 1);
  gas.grid[kCells] = {CodeOf({.columns = 1000, .rows = 1000, .is_lattice = true})};
  WriteTasks({{LeaseOf(gas), LeaseOf(SpecOf(kEquilibrium, Model::kBilliard))}});
  ProcessOptions command = Command();
  command.environment["SLURM_MEM_PER_CPU"] = "100";
  ASSERT_THAT(RunProgram(command), ExitsWith(0));
  const std::vector<ChunkFile> files = Files();
  ASSERT_EQ(files.size(), 1u);
  EXPECT_TRUE(files[0].is_final);
  EXPECT_EQ(files[0].memory_exceeded, 100.0 * (1 << 20));
  EXPECT_THAT(ChunksOfLease(0), IsEmpty());
  EXPECT_FALSE(ChunksOfLease(1).empty());
}

TEST_F(WorkerProgramTest, EndsWhenTheToleranceIsReached) {
  EnsembleSpec spec = SpecOf(kFirstHit, Model::kBilliard);
  spec.target = {.tolerance = 0.003};
  const IdentifiedLease lease = LeaseOf(spec);
  WriteTasks({{lease}});
  ASSERT_THAT(RunProgram(Command()), ExitsWith(0));
  PointFold fold(*lease.lease.experiment);
  const std::vector<ChunkResult> chunks = ChunksOfLease(0);
  EXPECT_GT(chunks.size(), 1u);
  for (const ChunkResult& chunk : chunks) {
    EXPECT_FALSE(fold.finished());
    fold.Add(chunk);
  }
  EXPECT_TRUE(fold.finished());
  EXPECT_TRUE(Files().back().is_final);
}

// The next run computes the rest of the chunks, and the last run nothing. If the task had ended
// before the second signal, the next task has twice as many samples.
TEST_F(WorkerProgramTest, ASignalledTaskContinuesWhereItStopped) {
  IdentifiedLease lease;
  std::vector<ChunkFile> before;
  for (int samples = 40'000; before.empty() || before.back().is_final; samples *= 2) {
    std::filesystem::remove_all(out_);
    std::filesystem::create_directory(out_);
    lease = LeaseOf(SpecOf(kEquilibrium, Model::kBilliardReference, samples));
    WriteTasks({{lease}});
    for (const int signal : {SIGUSR1, SIGTERM}) {
      Process first(Command({"--flush-seconds", "0"}));
      first.WaitForErr("wrote task-0.");
      first.Signal(signal);
      ASSERT_THAT(first.Wait(), ExitsWith(0));
    }
    before = Files();
    ASSERT_FALSE(before.empty());
    ASSERT_LT(samples, 10'000'000) << "the task does not end at a signal";
  }

  ASSERT_THAT(RunProgram(Command()), ExitsWith(0));
  EXPECT_EQ(Files().size(), before.size() + 1);
  EXPECT_TRUE(Files().back().is_final);
  EXPECT_TRUE(AreEqual(ChunksOfLease(0), AllChunks(*lease.lease.experiment)));

  ASSERT_THAT(RunProgram(Command()), ExitsWith(0));
  EXPECT_EQ(Files().size(), before.size() + 1);
}

TEST_F(WorkerProgramTest, ChunksOfADamagedFileAreComputedAgain) {
  const IdentifiedLease lease = LeaseOf(SpecOf(kFirstHit, Model::kBilliard, 100'000));
  WriteTasks({{lease}});
  ASSERT_THAT(RunProgram(Command({"--flush-seconds", "0"})), ExitsWith(0));
  const std::string damaged = out_ + "/task-0.1.chunks";
  const std::string bytes = Contents(damaged);
  ASSERT_FALSE(bytes.empty());
  WriteFile(damaged, bytes.substr(0, bytes.size() - 1));
  const ProcessResult second = RunProgram(Command());
  ASSERT_THAT(second, ExitsWith(0));
  EXPECT_THAT(second.err, AllOf(HasSubstr(damaged), HasSubstr("truncated")));
  std::filesystem::remove(damaged);
  std::map<uint64_t, ChunkResult> by_number;
  const std::vector<ChunkResult> found = ChunksOfLease(0);
  for (const ChunkResult& chunk : found) {
    EXPECT_TRUE(by_number.emplace(chunk.chunk, chunk).second) << chunk.chunk;
  }
  std::vector<ChunkResult> chunks;
  for (auto& [number, chunk] : by_number) chunks.push_back(std::move(chunk));
  EXPECT_TRUE(AreEqual(chunks, AllChunks(*lease.lease.experiment)));
}

// ---- errors ----

TEST_F(WorkerProgramTest, AnotherEngineVersionIsRefused) {
  IdentifiedLease lease = LeaseOf(SpecOf(kFirstHit, Model::kBilliard));
  lease.job.engine_version = "0.0.1";
  WriteTasks({{lease}});
  const ProcessResult result = RunProgram(Command());
  EXPECT_THAT(result, ExitsWith(3));
  EXPECT_THAT(result.err, AllOf(HasSubstr("0.0.1"), HasSubstr(kEngineVersion)));
  EXPECT_THAT(NamesIn(out_), IsEmpty());
}

TEST_F(WorkerProgramTest, WrongFlagsAreUsageErrors) {
  WriteTasks({{}});
  EXPECT_THAT(RunProgram({.command = {WorkerProgram()}}), ExitsWith(2));
  EXPECT_THAT(RunProgram(Command({"--flush-seconds", "-1"})), ExitsWith(2));
  EXPECT_THAT(RunProgram(Command({"--no-such-flag"})), ExitsWith(2));
  EXPECT_THAT(RunProgram(Command({}, 1)), ExitsWith(2));
}

TEST_F(WorkerProgramTest, ADamagedTaskFileIsRefused) {
  WriteTasks({{LeaseOf(SpecOf(kFirstHit, Model::kBilliard))}});
  std::string bytes = Contents(task_file_);
  bytes[bytes.size() / 2] ^= 1;
  WriteFile(task_file_, bytes);
  const ProcessResult result = RunProgram(Command());
  EXPECT_THAT(result, ExitsWith(1));
  EXPECT_THAT(result.err, HasSubstr("corrupted"));
}

const std::vector<std::string> kFewRetries = {"--retry-seconds", "0.001", "--give-up-seconds",
                                              "0.003"};

TEST_F(WorkerProgramTest, GivesUpOnAFolderThatDoesNotExist) {
  WriteTasks({{LeaseOf(SpecOf(kFirstHit, Model::kBilliard))}});
  std::filesystem::remove(out_);
  const ProcessResult result = RunProgram(Command(kFewRetries));
  EXPECT_THAT(result, ExitsWith(1));
  EXPECT_THAT(result.err, AllOf(HasSubstr(out_), HasSubstr("retry in 0.001 s")));
}

TEST_F(WorkerProgramTest, GivesUpOnAFullFolder) {
  WriteTasks({{LeaseOf(SpecOf(kFirstHit, Model::kBilliard))}});
  ProcessOptions command = Command(kFewRetries);
  command.command.insert(command.command.begin(), {"/usr/bin/prlimit", "--fsize=100:100"});
  const ProcessResult result = RunProgram(command);
  EXPECT_THAT(result, ExitsWith(1));
  EXPECT_THAT(result.err, AllOf(HasSubstr("task-0.0.chunks"), HasSubstr("retry in")));
  EXPECT_THAT(NamesIn(out_), IsEmpty());
}

TEST_F(WorkerProgramTest, WaitsForAFolder) {
  WriteTasks({{LeaseOf(SpecOf(kFirstHit, Model::kBilliard))}});
  std::filesystem::remove(out_);
  Process worker(Command({"--retry-seconds", "0.01"}));
  ASSERT_TRUE(worker.WaitForErr("retry in"));
  std::filesystem::create_directory(out_);
  EXPECT_THAT(worker.Wait(), ExitsWith(0));
  EXPECT_EQ(Files().size(), 1u);
}

// ---- the file of the program ----

TEST(WorkerProgram, PrintsItsEngineVersion) {
  const ProcessResult result = RunProgram({.command = {WorkerProgram(), "--version"}});
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.out, absl::StrCat(kEngineVersion, "\n"));
}

#ifdef BALLPISTON_STATIC_WORKER
TEST(WorkerProgram, RunsInAnEmptyFolderSystem) {
  const TemporaryFolder root;
  std::filesystem::copy_file(WorkerProgram(), root.File("ballpiston-worker"));
  const ProcessResult result =
      RunProgram({.command = {"/usr/sbin/chroot", root.path(), "/ballpiston-worker", "--version"}});
  if (result.exit_code == 125) GTEST_SKIP() << "chroot is not permitted";
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.out, absl::StrCat(kEngineVersion, "\n"));
}
#endif

}  // namespace
}  // namespace ballpiston::server
