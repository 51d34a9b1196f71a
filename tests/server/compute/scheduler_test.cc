#include "server/compute/scheduler.h"

#include <ctime>
#include <new>

#include "tests/server/compute/run_requests.h"
#include "tests/server/compute/stepped_executor.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

JournalPointer AddRun(ThreadPool& pool, int64_t key, const EnsembleSpec& spec,
                      const std::string& principal = "", int32_t priority = 0) {
  auto journal = std::make_shared<RecordingJournal>();
  RunRequest request = RunOf(key, spec, journal);
  request.principal = principal;
  request.priority = priority;
  pool.Add(std::move(request));
  return journal;
}

TEST(Scheduler, APointIsResumedFromItsCheckpoint) {
  const EnsembleSpec spec = FakeSpec(2, 80);
  auto journal = std::make_shared<RecordingJournal>();
  journal->stored[1] = FakeState(spec, 1, 45);
  std::mutex mutex;
  std::set<uint64_t> computed;
  ThreadPool pool(3, FakeExperiments([&](size_t point, uint64_t block, std::stop_token) {
                    std::lock_guard lock(mutex);
                    if (point == 1) computed.insert(block);
                  }));
  pool.Add(RunOf(1, spec, journal));
  ASSERT_OK(journal->AwaitEnd());
  ExpectAllPointsRight(spec, *journal);
  EXPECT_EQ(computed.size(), 35u);
  EXPECT_EQ(*computed.begin(), 45u);
  EXPECT_EQ(journal->restored[1], 45 * kFakeSamplesPerBlock);
}

TEST(Scheduler, ACheckpointOfAnotherShapeEndsTheRun) {
  const EnsembleSpec spec = FakeSpec(1, 3);
  auto journal = std::make_shared<RecordingJournal>();
  journal->stored[0] = FakeState(spec, 0, 2);
  journal->stored[0].partial.moments.resize(1000);
  ThreadPool pool(2, FakeExperiments());
  pool.Add(RunOf(1, spec, journal));
  EXPECT_THAT(journal->AwaitEnd(), StatusIs(absl::StatusCode::kDataLoss));
  EXPECT_TRUE(journal->finished.empty());
}

// A later pool continues from the state at the shutdown of the first one.
TEST(Scheduler, AShutdownWritesACheckpoint) {
  const EnsembleSpec spec = FakeSpec(1, 80);
  Gate gate;
  ThreadPool pool(1, GatedExperiments(gate, 50));
  const auto journal = AddRun(pool, 1, spec);
  gate.AwaitWaiting(1);
  pool.Shutdown();
  const auto later = std::make_shared<RecordingJournal>();
  later->stored = journal->checkpoints;
  ThreadPool next(2, FakeExperiments());
  next.Add(RunOf(1, spec, later));
  ASSERT_OK(later->AwaitEnd());
  ExpectAllPointsRight(spec, *later);
  EXPECT_EQ(later->restored[0], 50 * kFakeSamplesPerBlock);
}

// ---- budgets ----

// This budget is spent when the first block is merged, on every machine.
constexpr double kSpentAtOnce = 1e-12;

EnsembleSpec FakeBudget(int points) {
  EnsembleSpec spec = FakeSpec(points, 0);
  spec.target = {.budget_seconds = kSpentAtOnce};
  return spec;
}

TEST(Scheduler, ASpentBudgetEndsAPointAtABlocksEnd) {
  const EnsembleSpec spec = FakeBudget(5);
  for (const int workers : {1, 4}) {
    ThreadPool pool(workers, FakeExperiments());
    const auto journal = AddRun(pool, 1, spec);
    EXPECT_OK(journal->AwaitEnd());
    ASSERT_EQ(journal->finished.size(), 5u);
    for (const auto& [point, merged] : journal->finished) {
      const uint64_t blocks = journal->merged[point] / kFakeSamplesPerBlock;
      // Blocks that were out of order when the first came are merged with it.
      EXPECT_GE(blocks, 1u);
      EXPECT_LT(blocks, 1000u);
      EXPECT_TRUE(merged == FakeMerged(spec, point, blocks)) << "point " << point;
    }
  }
}

// With one worker one block is merged at a time, so nothing but the first.
TEST(Scheduler, AMissedToleranceIsReportedAfterAllPointsAreFinished) {
  EnsembleSpec spec = FakeBudget(5);
  spec.target.tolerance = 0.001;
  ThreadPool pool(1, FakeExperiments());
  const auto journal = AddRun(pool, 1, spec);
  const absl::Status outcome = journal->AwaitEnd();
  EXPECT_THAT(outcome, StatusIs(absl::StatusCode::kDeadlineExceeded));
  EXPECT_EQ(journal->finished.size(), 5u);
  for (const auto& [point, merged] : journal->finished) {
    EXPECT_TRUE(merged == FakeMerged(spec, point, 1)) << "point " << point;
  }
  // That of the point that came first.
  const BlockResult merged = FakeMerged(spec, 0, 1);
  const double reached = *merged.moments[0].StandardError() / merged.moments[0].mean;
  EXPECT_EQ(std::string(outcome.message()),
            absl::StrFormat("point 0: tolerance 0.001 was not reached within the budget of 1e-12 "
                            "s: reached %.2g",
                            reached));
}

TEST(Scheduler, AReachedToleranceEndsBeforeTheBudget) {
  EnsembleSpec spec = FakeSpec(3, 0);
  spec.target = {.tolerance = 0.05};
  EnsembleSpec with_budget = spec;
  with_budget.target.budget_seconds = 1e6;
  for (const EnsembleSpec& asked : {spec, with_budget}) {
    ThreadPool pool(1, FakeExperiments());
    const auto journal = AddRun(pool, 1, asked);
    EXPECT_OK(journal->AwaitEnd());
    ASSERT_EQ(journal->finished.size(), 3u);
    for (const auto& [point, merged] : journal->finished) {
      EXPECT_GT(merged.samples, 64u);  // more than one chunk
      EXPECT_LT(merged.samples, 1000 * kFakeSamplesPerBlock);
      EXPECT_TRUE(merged == FakeMerged(spec, point, merged.samples / kFakeSamplesPerBlock));
    }
  }
}

TEST(Scheduler, ProcessorTimeIsReportedOfPilotsAndBlocksAlike) {
  // Uses some processor time of the thread, also on a busy machine.
  const auto compute = [] {
    timespec begin{}, now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &begin);
    do {
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    } while (now.tv_sec == begin.tv_sec && now.tv_nsec - begin.tv_nsec < 2'000'000);
  };
  ThreadPool pool(2, [&](const EnsembleSpec& spec, size_t index) {
    if (spec.seed == 2) compute();
    return FakeExperiments([&, seed = spec.seed](size_t, uint64_t, std::stop_token) {
      if (seed == 2) compute();
    })(spec, index);
  });
  const auto idle = AddRun(pool, 1, FakeSpec(1, 4, 1));
  ASSERT_OK(idle->AwaitEnd());
  const auto busy = AddRun(pool, 2, FakeSpec(1, 4, 2));
  ASSERT_OK(busy->AwaitEnd());
  EXPECT_GT(idle->work, 0);
  // At least one of five in each second of the clock: a turn of the second cuts one short.
  EXPECT_GE(busy->work, 4 * 0.002);
}

TEST(Scheduler, AnExceptionFailsItsRunOnly) {
  ThreadPool pool(2,
                  FakeExperimentsBySeed([](uint64_t seed, size_t, uint64_t block, std::stop_token) {
                    if (seed == 13 && block == 5)
                      throw std::runtime_error("the ball left the cell");
                    if (seed == 14 && block == 5) throw std::bad_alloc();
                  }));
  const auto bad = AddRun(pool, 1, FakeSpec(3, 20, 13));
  const auto hungry = AddRun(pool, 2, FakeSpec(3, 20, 14));
  const auto good = AddRun(pool, 3, FakeSpec(3, 20, 15));
  EXPECT_OK(good->AwaitEnd());
  EXPECT_THAT(std::string(bad->AwaitEnd().message()), HasSubstr("the ball left the cell"));
  EXPECT_THAT(std::string(hungry->AwaitEnd().message()), HasSubstr("out of memory"));
  ExpectAllPointsRight(FakeSpec(3, 20, 15), *good);
}

// The runs are added while a first run blocks the only worker, so that all are present when it goes
// on.
TEST(Scheduler, AHigherPriorityIsServedFirst) {
  Gate gate;
  std::vector<uint64_t> begun;  // the seed of the run, for each block
  ThreadPool pool(1,
                  FakeExperimentsBySeed([&](uint64_t seed, size_t, uint64_t, std::stop_token stop) {
                    begun.push_back(seed);
                    if (seed == 1) gate.Pass(stop);
                  }));
  std::vector<JournalPointer> journals;
  const auto add = [&](int64_t key, int32_t priority, uint64_t seed, int64_t blocks) {
    journals.push_back(AddRun(pool, key, FakeSpec(2, blocks, seed), "a", priority));
  };
  add(1, 0, 1, 1);
  gate.AwaitWaiting(1);
  add(2, -7, 2, 10);
  add(3, 0, 3, 10);
  add(4, 7, 4, 10);
  gate.Open();
  for (const auto& journal : journals) EXPECT_OK(journal->AwaitEnd());
  // The first run's second point comes when its priority's turn has come.
  std::erase(begun, 1u);
  std::vector<uint64_t> expected;
  for (const uint64_t seed : {4u, 3u, 2u}) expected.insert(expected.end(), 20, seed);
  EXPECT_EQ(begun, expected);
}

}  // namespace
}  // namespace ballpiston::server
