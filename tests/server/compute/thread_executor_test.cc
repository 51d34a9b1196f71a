#include "server/compute/thread_executor.h"

#include <ctime>
#include <latch>
#include <new>

#include "core/gpu/device_orbits.h"
#include "tests/core/billiard/each_target.h"
#include "tests/core/gpu/host_flights.h"
#include "tests/core/one_point_spec.h"
#include "tests/server/compute/stepped_scheduler.h"
#include "tests/server/preamble.h"
#include "tests/support/nightly.h"

namespace ballpiston::server {
namespace {

// The journal of a run that threads have computed.
JournalPointer Ran(const ExperimentFactory& factory, const EnsembleSpec& spec, int workers = 2,
                   OrbitDevice* device = nullptr,
                   const std::shared_ptr<CrashRecord>& record = std::make_shared<CrashRecord>(),
                   JournalPointer journal = std::make_shared<RecordingJournal>()) {
  ThreadPool pool(workers, factory, record, device);
  pool.scheduler().Add(RunOf(1, spec, journal));
  journal->AwaitEnd();
  return journal;
}

BlockResult ResultOf(const EnsembleSpec& spec, OrbitDevice* device, int workers = 2) {
  return Ran([](const EnsembleSpec& of, size_t i) { return PointExperiment::Create(of, i); }, spec,
             workers, device)
      ->finished.at(0);
}

TEST(ThreadExecutor, AnExceptionFailsItsRunOnly) {
  ThreadPool pool(2,
                  FakeExperimentsBySeed([](uint64_t seed, size_t, uint64_t block, std::stop_token) {
                    if (seed == 1 && block == 5) throw std::runtime_error("the ball left the cell");
                    if (seed == 2 && block == 5) throw std::bad_alloc();
                  }));
  std::map<uint64_t, JournalPointer> journals;
  for (const uint64_t seed : {1, 2, 3}) {
    journals[seed] = std::make_shared<RecordingJournal>();
    pool.scheduler().Add(RunOf(static_cast<int64_t>(seed), FakeSpec(3, 20, seed), journals[seed]));
  }
  for (const auto& [seed, journal] : journals) journal->AwaitEnd();
  EXPECT_THAT(*journals[1]->outcome,
              StatusIs(absl::StatusCode::kInternal, HasSubstr("the ball left the cell")));
  EXPECT_THAT(*journals[2]->outcome,
              StatusIs(absl::StatusCode::kResourceExhausted, HasSubstr("out of memory")));
  ExpectComplete(FakeSpec(3, 20, 3), *journals[3]);
}

// The test reads the clock itself, in nanoseconds.
TEST(ThreadExecutor, ProcessorTimeIsReportedOfOpeningsAndBlocksAlike) {
  const auto nanoseconds = [] {
    timespec time = {};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1'000'000'000 * time.tv_sec + time.tv_nsec;
  };
  const auto compute = [&] {
    const int64_t begin = nanoseconds();
    while (nanoseconds() - begin < 2'000'000) continue;
  };
  const ExperimentFactory slow = [&](const EnsembleSpec& spec, size_t index) {
    compute();
    return FakeExperiments([&](size_t, uint64_t, std::stop_token) { compute(); })(spec, index);
  };
  EXPECT_GE(Ran(slow, FakeSpec(1, 4))->work, 5 * 0.002);  // an opening and four blocks
}

// The test saves the record during a block and during a wait for the disk. It simulates that the
// kernel killed the process at that time, and counts the deaths that the next process finds.
TEST(ThreadExecutor, ARunIsInTheRecordOnlyWhileItIsComputed) {
  const OutOfMemoryKills before = {"group", 7}, after = {"group", 8};
  const TemporaryFolder folder;
  std::string in_a_block, in_a_wait;
  const auto record = [&] { return Contents(folder.File("computing")); };
  const auto journal = std::make_shared<RecordingJournal>();
  journal->await_room = [&] {
    in_a_wait = record();
    return 0;
  };
  Ran(FakeExperiments([&](size_t, uint64_t, std::stop_token) { in_a_block = record(); }),
      FakeSpec(1, 3), 1, nullptr, std::make_shared<CrashRecord>(folder.path(), before), journal);
  for (const auto& [left, deaths] : {std::pair(in_a_block, 1), {in_a_wait, 0}}) {
    WriteFile(folder.File("computing"), left);
    EXPECT_EQ(CrashRecord(folder.path(), after).Deaths({1, 0}), deaths);
  }
}

// While one thread computes a slow block, the others must find blocks for all their lanes.
TEST(ThreadExecutor, TheWindowGrowsWithTheThreads) {
  constexpr int kBeyondTheWindow = ChunkFold::kWindow + 100;
  std::latch begun(kBeyondTheWindow);
  Ran(FakeExperiments([&](size_t, uint64_t block, std::stop_token) {
        if (block < kBeyondTheWindow) begun.count_down();
        if (block == 0) begun.wait();
      }),
      FakeSpec(1, 3000));
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

// In a build with CUDA the device is a GPU. With BALLPISTON_NIGHTLY the samples are enough to keep
// the GPU busy.
TEST(ThreadExecutor, EveryExperimentWithAPairHasTheSameBitsOnADevice) {
  if (!LanesAreFused()) GTEST_SKIP();
  auto cuda = OpenCuda();
  const double events = !cuda.ok() ? 1e4 : IsNightly() ? 2e9 : 1e7;
  const int workers = cuda.ok() ? static_cast<int>(std::thread::hardware_concurrency()) : 2;
  OrbitsOnDevice device(cuda.ok() ? *std::move(cuda) : std::make_unique<HostDevice>(64), workers,
                        [](const absl::Status& status) { ADD_FAILURE() << status; });
  for (const double rho : {0.501, kPaperRho, 0.7}) {
    for (const double share : {0.9, 0.3, 0.05}) {
      for (const ExperimentKind* kind : {&kEquilibrium, &kConditionalMeanFreeTime, &kFirstHit,
                                         &kMarkovProperty, &kEnergyRelaxation}) {
        PointParameters point = {{kRho, rho}, {kDelta, share * PairDeltaBound(rho)}};
        if (kind == &kFirstHit || kind == &kConditionalMeanFreeTime) point.Set(kEpsilon, 0.125);
        if (kind == &kFirstHit) point.Set(kExponent, 1);
        EnsembleSpec spec = SpecOf(kind, point, {.samples = 100}, Model::kBilliard, 5);
        const ChunkPlan plan = PointExperiment::Create(spec, 0)->plan();
        spec.target.samples = static_cast<int64_t>(1 + events / plan.events_per_sample());
        SCOPED_TRACE(absl::StrCat(kind->name, ", rho ", rho, ", delta ", *point.Find(kDelta)));
        EXPECT_TRUE(ResultOf(spec, &device, workers) == ResultOf(spec, nullptr, workers));
      }
    }
  }
}

}  // namespace
}  // namespace ballpiston::server
