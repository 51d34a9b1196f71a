// The program ballpiston-worker.
#include <sys/syscall.h>

#include "core/engine_version.h"
#include "server/worker/shared_files.h"
#include "tests/server/worker/sample_leases.h"
#include "tests/support/process.h"

namespace ballpiston::server {
namespace {

std::string WorkerProgram() { return BuildPath("bin/ballpiston-worker"); }

// A shared folder without a server.
class WorkerProgramTest : public testing::Test {
 protected:
  WorkerProgramTest() {
    for (const char* name : {"", "/todo", "/taken", "/done"}) {
      std::filesystem::create_directory(shared_ + name);
    }
  }

  void Lay(const std::string& name, const Lease& lease, double touch_seconds = 20) {
    ASSERT_OK(files_.Create("todo/" + name, FileOf(lease, touch_seconds)).status());
  }

  ProcessOptions Command(std::vector<std::string> further = {}) const {
    ProcessOptions options = {.command = {WorkerProgram(), shared_, "--idle-seconds=0"}};
    options.command.insert(options.command.end(), further.begin(), further.end());
    return options;
  }

  // The limit on file sizes has the effect of a full disk. It also applies to files in memory, so
  // the output goes through a pipe.
  ProcessOptions InAFullFolder(std::vector<std::string> further) const {
    ProcessOptions options = Command(std::move(further));
    options.command.insert(
        options.command.begin(),
        {"bash", "-o", "pipefail", "-c", "prlimit --fsize=100:100 \"$@\" 2>&1 | cat >&2", "bash"});
    return options;
  }

  // The names in done/, without the worker's.
  std::vector<std::string> Done() const {
    std::vector<std::string> names;
    for (const std::string& name : NamesIn(shared_ + "/done")) {
      names.push_back(name.substr(0, name.find('.')) + name.substr(name.rfind('.')));
    }
    return names;
  }

  // Bytes of the largest file.
  size_t LargestIn(const std::string& subfolder) {
    size_t most = 0;
    for (const std::string& name : NamesIn(shared_ + "/" + subfolder)) {
      const auto stamp = files_.Stamp(subfolder + "/" + name);
      if (stamp.ok()) most = std::max(most, stamp->bytes);
    }
    return most;
  }

  const TemporaryFolder folder_;
  const std::string shared_ = folder_.File("shared");
  FolderFiles files_ = FolderFiles(shared_);
};

TEST_F(WorkerProgramTest, ACrashMovesTheLeaseThatWasComputed) {
  EnsembleSpec crash = SpecOf(kEquilibrium, Model::kBilliard);
  crash.seed = 13;
  Lay("a", LeaseOf(crash));
  ProcessOptions command = Command();
  command.environment["BALLPISTON_FAILPOINT"] = "crash-for-seed:13";
  // A sanitizer reports the signal and exits with a code of its own.
  EXPECT_THAT(RunProgram(command), testing::Not(ExitsWith(0)));
  EXPECT_THAT(Done(), ElementsAre("a.crashed"));
}

// On NFS a worker dies of SIGBUS when its program is replaced. The test sends the signal in the
// name of the worker, because the handler ignores signals of other processes.
TEST_F(WorkerProgramTest, ABusErrorLeavesTheLeaseInItsPlace) {
  Lay("a", LeaseOf(SpecOf(kEquilibrium, Model::kBilliardReference, 5'000'000)), 1e-9);
  const size_t bytes = LargestIn("todo");
  Process worker(Command());
  AwaitThat([&] { return LargestIn("taken") > bytes; });
  siginfo_t info{};
  info.si_code = SI_QUEUE;
  info.si_pid = worker.pid();
  ASSERT_EQ(syscall(SYS_rt_sigqueueinfo, worker.pid(), SIGBUS, &info), 0);
  EXPECT_THAT(worker.Wait(), testing::Not(ExitsWith(0)));
  EXPECT_THAT(Done(), IsEmpty());
}

// Slurm says MiB. Lanes of a gas of 1000 x 1000 cells take some 700 MB.
TEST_F(WorkerProgramTest, ALeaseThatNeedsMoreMemoryThanSlurmGivesIsLeftOut) {
  EnsembleSpec gas = SpecOf(kGasEquilibrium, Model::kBilliard, 1);
  gas.grid[kCells] = {CodeOf({.columns = 1000, .rows = 1000, .is_lattice = true})};
  Lay("a", LeaseOf(gas));
  ProcessOptions command = Command();
  command.environment["SLURM_MEM_PER_CPU"] = "100";
  ASSERT_THAT(RunProgram(command), ExitsWith(0));
  EXPECT_THAT(Done(), ElementsAre("a.no-memory"));
}

// A worker that touches its file as often as it can has chunks in the file early. If it finishes
// the lease before the signal, the next lease has twice as many samples.
TEST_F(WorkerProgramTest, ASignalledWorkerGivesItsLeaseBackWithItsChunks) {
  for (const int signal : {SIGUSR1, SIGTERM}) {
    for (int samples = 40'000;; samples *= 2) {
      ASSERT_LT(samples, 10'000'000) << "the worker does not end at a signal";
      const Lease lease = LeaseOf(SpecOf(kEquilibrium, Model::kBilliardReference, samples));
      const size_t bytes = FileOf(lease, 1e-9).size();
      Lay("a", lease, 1e-9);
      Process worker(Command());
      AwaitThat([&] { return !Done().empty() || LargestIn("taken") > bytes; });
      worker.Signal(signal);
      ASSERT_THAT(worker.Wait(), ExitsWith(0));
      const std::string file = shared_ + "/done/" + NamesIn(shared_ + "/done").at(0);
      const std::vector<ChunkResult> chunks = ReportsIn(Contents(file)).chunks;
      const bool is_finished = Done() == std::vector<std::string>{"a.finished"};
      std::filesystem::remove(file);
      if (is_finished) continue;
      EXPECT_TRUE(file.ends_with(".returned")) << file;
      ASSERT_FALSE(chunks.empty());
      std::vector<ChunkResult> first = ComputedChunks(lease);
      first.resize(chunks.size());
      EXPECT_TRUE(AreEqual(chunks, first));
      break;
    }
  }
}

// ---- errors ----

TEST_F(WorkerProgramTest, WrongFlagsAreUsageErrors) {
  EXPECT_THAT(RunProgram({.command = {WorkerProgram()}}), ExitsWith(2));
  EXPECT_THAT(RunProgram({.command = {WorkerProgram(), ""}}), ExitsWith(2));
  for (const char* flag : {"--for=-1", "--for=nan", "--idle-seconds=nan", "--retry-seconds=nan",
                           "--give-up-seconds=nan", "--no-such-flag"}) {
    EXPECT_THAT(RunProgram({.command = {WorkerProgram(), shared_, flag}}), ExitsWith(2)) << flag;
  }
}

TEST_F(WorkerProgramTest, WaitsForRoomInAFullFolderAndGivesUp) {
  Lay("a", LeaseOf(SpecOf(kFirstHit, Model::kBilliard)));
  const ProcessResult result =
      RunProgram(InAFullFolder({"--retry-seconds=0.5", "--give-up-seconds=4"}));
  EXPECT_THAT(result, ExitsWith(1));
  EXPECT_THAT(result.err, AllOf(HasSubstr("cannot be written"), HasSubstr("retry in")));
  EXPECT_THAT(Done(), IsEmpty());
}

// Without waits the worker would try again and again in its last second, with a line each time. On
// a busy machine the worker may end before it takes the lease.
TEST_F(WorkerProgramTest, WaitsBetweenItsLastAttempts) {
  Lay("a", LeaseOf(SpecOf(kFirstHit, Model::kBilliard)));
  const std::string err = RunProgram(InAFullFolder({"--retry-seconds=0.5", "--for=4"})).err;
  EXPECT_LE(std::count(err.begin(), err.end(), '\n'), 20) << err;
}

// ---- the file of the program ----

TEST(WorkerProgram, PrintsItsEngineVersion) {
  const ProcessResult result = RunProgram({.command = {WorkerProgram(), "--version"}});
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.out, absl::StrCat(EngineVersion(), "\n"));
}

#ifdef BALLPISTON_STATIC_WORKER
#ifdef __x86_64__
// Its results differ in the last bits, so its engine is another one.
TEST(WorkerProgram, HasAnotherEngineWithoutFusedMultiplyAdd) {
  const ProcessResult result =
      RunProgram({.command = {"env", "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2", WorkerProgram(),
                              "--version"}});
  EXPECT_EQ(result.out, absl::StrCat(kEngineVersion, "-unfused\n")) << result.err;
}
#endif

TEST(WorkerProgram, RunsInAnEmptyFolderSystem) {
  const TemporaryFolder root;
  std::filesystem::copy_file(WorkerProgram(), root.File("ballpiston-worker"));
  const ProcessResult result =
      RunProgram({.command = {"/usr/sbin/chroot", root.path(), "/ballpiston-worker", "--version"}});
  if (result.exit_code == 125 || result.exit_code == 126) GTEST_SKIP() << result.err;
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.out, absl::StrCat(EngineVersion(), "\n"));
}
#endif

}  // namespace
}  // namespace ballpiston::server
