#include "server/compute/thread_executor.h"

#include <latch>

#include "core/gpu/device_orbits.h"
#include "tests/core/billiard/each_target.h"
#include "tests/core/gpu/host_flights.h"
#include "tests/core/one_point_spec.h"
#include "tests/server/compute/stepped_scheduler.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

// What the next process finds if the kernel kills this one during a block, and during a wait for
// the disk.
TEST(ThreadExecutor, ARunIsInTheRecordOnlyWhileItIsComputed) {
  const OutOfMemoryKills before = {"group", 7}, after = {"group", 8};
  const TemporaryFolder folder, in_a_block, in_a_wait;
  const auto keep = [&](const TemporaryFolder& copy) {
    std::filesystem::copy_file(folder.File("computing"), copy.File("computing"),
                               std::filesystem::copy_options::overwrite_existing);
  };
  FactoryOpener opener(
      FakeExperiments([&](size_t, uint64_t, std::stop_token) { keep(in_a_block); }));
  Scheduler scheduler(opener, 1);
  ThreadExecutor threads(scheduler, 1, std::numeric_limits<double>::infinity(),
                         std::make_shared<CrashRecord>(folder.path(), before));
  const auto journal = std::make_shared<RecordingJournal>();
  journal->await_room = [&] {
    keep(in_a_wait);
    return 0;
  };
  scheduler.Add(RunOf(1, FakeSpec(1, 3), journal));
  threads.Start();
  EXPECT_OK(journal->AwaitEnd());
  scheduler.Shutdown();
  EXPECT_EQ(CrashRecord(in_a_block.path(), after).Deaths({1, 0}), 1);
  EXPECT_EQ(CrashRecord(in_a_wait.path(), after).Deaths({1, 0}), 0);
}

std::unique_ptr<const PointExperiment> OpenReal(const EnsembleSpec& spec, size_t index) {
  return PointExperiment::Create(spec, index);
}

BlockResult ResultOf(const EnsembleSpec& spec, OrbitDevice* device, int workers = 2) {
  FactoryOpener opener(OpenReal);
  Scheduler scheduler(opener, workers);
  ThreadExecutor threads(scheduler, workers, kInfinity, std::make_shared<CrashRecord>(), device);
  const auto journal = std::make_shared<RecordingJournal>();
  scheduler.Add(RunOf(1, spec, journal));
  threads.Start();
  EXPECT_OK(journal->AwaitEnd());
  scheduler.Shutdown();
  return journal->finished.at(0);
}

// While one thread computes a slow block, the others must find blocks for all their lanes.
TEST(ThreadExecutor, TheWindowGrowsWithTheThreads) {
  constexpr int kBeyondTheWindow = ChunkFold::kWindow + 100;
  std::latch begun(kBeyondTheWindow);
  FactoryOpener opener(FakeExperiments([&](size_t, uint64_t block, std::stop_token) {
    if (block < kBeyondTheWindow) begun.count_down();
    if (block == 0) begun.wait();
  }));
  Scheduler scheduler(opener, 2);
  ThreadExecutor threads(scheduler, 2);
  const auto journal = std::make_shared<RecordingJournal>();
  scheduler.Add(RunOf(1, FakeSpec(1, 3000), journal));
  threads.Start();
  EXPECT_OK(journal->AwaitEnd());
}

// Otherwise blocks of long orbits would be dropped more often than others. False alarms: 6e-5.
TEST(ThreadExecutor, ASpentBudgetAwaitsTheBlocksThatHaveBegun) {
  BlockResult all;
  EnsembleSpec spec = SpecOf(&kConditionalMeanFreeTime, PaperPoint(0.05, 0.125),
                             {.budget_seconds = 1e-12}, Model::kBilliard);
  for (spec.seed = 1; spec.seed <= 40; ++spec.seed) all.Merge(ResultOf(spec, nullptr, 1));
  const PointSummary summary = PointExperiment::Create(spec, 0)->Summarize(all);
  EXPECT_LT(std::fabs(*summary.estimates.front().ZScore()), 4);
}

// ---- a device ----

// Processors without fused multiply-add give other bits than devices.
TEST(ThreadExecutor, AJobOnADeviceHasTheSameBitsAlsoIfTheDeviceFails) {
  if (!LanesAreFused()) GTEST_SKIP();
  const EnsembleSpec spec =
      SpecOf(&kFirstHit, PaperPoint(0.2, 0.125, 1), {.samples = 3000}, Model::kBilliard);
  const BlockResult expected = ResultOf(spec, nullptr);
  for (const HostFaults& faults : {HostFaults(), HostFaults{.make = 1}, HostFaults{.land = 3}}) {
    int failures = 0;
    OrbitsOnDevice device(std::make_unique<HostDevice>(64, faults), 2,
                          [&](const absl::Status&) { ++failures; });
    EXPECT_TRUE(ResultOf(spec, &device) == expected);
    EXPECT_EQ(failures, faults.make || faults.land ? 1 : 0);
  }
}

}  // namespace
}  // namespace ballpiston::server
