// Which leases executors get, which of their reports count, and how a run ends.
// tests/core/ensemble/point_fold_test.cc and tests/simulation test that any order of reports gives
// the same bytes.
#include "server/compute/scheduler.h"

#include "tests/core/asked.h"
#include "tests/server/compute/stepped_scheduler.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

// ---- checkpoints ----

TEST_F(SchedulerTest, AShutdownWritesACheckpointFromWhichALaterProcessGoesOn) {
  const EnsembleSpec spec = FakeSpec(2, 80);
  const auto journal = Add(1, spec);
  TakeTurn();  // opens the first point
  TakeTurn(45);
  scheduler_.Shutdown();
  ASSERT_EQ(journal->checkpoints.size(), 1u);

  std::multiset<uint64_t> computed;  // blocks of the first point
  SteppedScheduler next(FakeExperiments([&](size_t point, uint64_t block, std::stop_token) {
    if (point == 0) computed.insert(block);
  }));
  const auto later = next.Add(1, spec, [&](RunRequest&, RecordingJournal& of_later) {
    of_later.stored = journal->checkpoints;
  });
  next.TakeAllTurns();
  ExpectComplete(spec, *later);
  EXPECT_EQ(later->restored[0], 45 * kFakeSamplesPerBlock);
  EXPECT_EQ(computed.size(), 35u);
  EXPECT_EQ(*computed.begin(), 45u);
}

TEST_F(SchedulerTest, ACheckpointOfAnotherShapeEndsTheRun) {
  const EnsembleSpec spec = FakeSpec(1, 3);
  const auto journal = Add(1, spec, [&](RunRequest&, RecordingJournal& later) {
    later.stored[0] = FakeState(spec, 0, 2);
    later.stored[0].partial.moments.resize(1000);
  });
  TakeAllTurns();
  ASSERT_TRUE(journal->outcome);
  EXPECT_THAT(*journal->outcome, StatusIs(absl::StatusCode::kDataLoss));
  EXPECT_TRUE(journal->finished.empty());
}

TEST_F(SchedulerTest, ACheckpointThatCannotBeReadNowIsReadAgain) {
  const EnsembleSpec spec = FakeSpec(1, 3);
  const auto journal = Add(1, spec, [&](RunRequest&, RecordingJournal& later) {
    later.stored[0] = FakeState(spec, 0, 2);
    later.unreadable = 2;
  });
  TakeAllTurns();
  ExpectComplete(spec, *journal);
  EXPECT_EQ(journal->restored[0], 2 * kFakeSamplesPerBlock);
}

// ---- budgets and tolerances ----

// This budget is spent when the first block is merged, on every machine. With one thread one block
// is merged at a time.
constexpr double kSpentAtOnce = 1e-12;

EnsembleSpec WithTarget(int points, const Target& target) {
  EnsembleSpec spec = FakeSpec(points, 0);
  spec.target = target;
  return spec;
}

// A fake point has 1000 blocks at most.
TEST_F(SchedulerTest, AToleranceAloneThatTheMostSamplesDoNotReachIsMissed) {
  const EnsembleSpec spec = WithTarget(2, {.tolerance = 1e-6});
  const auto journal = Add(1, spec);
  TakeAllTurns();
  EXPECT_EQ(journal->finished.size(), 2u);
  EXPECT_EQ(journal->finished.at(0), FakeMerged(spec, 0, 1000));
  EXPECT_THAT(*journal->outcome,
              StatusIs(absl::StatusCode::kDeadlineExceeded, HasSubstr("point 0: tolerance 1e-06")));

  const auto later = Add(2, spec, [&](RunRequest& request, RecordingJournal& of_later) {
    of_later.stored[1] = FakeState(spec, 1, 1000);  // the end of the point
    request.finished[0] = true;
  });
  TakeAllTurns();
  EXPECT_TRUE(later->merged.empty());
  EXPECT_THAT(*later->outcome,
              StatusIs(absl::StatusCode::kDeadlineExceeded, HasSubstr("point 1: tolerance 1e-06")));
}

TEST_F(SchedulerTest, ARunWithoutAPointLeftEndsAtOnce) {
  const auto journal = Add(1, FakeSpec(1, 3), [](RunRequest& request, RecordingJournal&) {
    request.finished[0] = true;
  });
  ASSERT_TRUE(journal->outcome);
  EXPECT_OK(*journal->outcome);
}

TEST(Budget, TrajectoriesEndWithTheirFirstStageAtTheEarliest) {
  SteppedScheduler stepped(
      [](const EnsembleSpec& spec, size_t point) { return PointExperiment::Create(spec, point); });
  const EnsembleSpec spec = Asked("gas-conduction model=markov budget=1e-12");
  const auto journal = stepped.Add(1, spec);
  stepped.TakeAllTurns();
  const ChunkPlan plan = PointExperiment::Create(spec, 0)->plan();
  EXPECT_EQ(journal->finished.at(0).samples, plan.SamplesBefore(plan.groups()));
}

// Each point ends with its first block, with fewer samples than a tolerance requires without a
// budget (docs/answers.md). A miss is reported after all points are finished.
TEST_F(SchedulerTest, AtTheEndOfABudgetTheStatedErrorAloneDecides) {
  const auto outcome_of = [&](int64_t key, double tolerance) {
    const EnsembleSpec spec =
        WithTarget(5, {.tolerance = tolerance, .budget_seconds = kSpentAtOnce});
    const auto journal = Add(key, spec);
    TakeAllTurns();
    EXPECT_EQ(journal->finished.size(), 5u);
    for (const auto& [point, merged] : journal->finished) {
      EXPECT_EQ(merged, FakeMerged(spec, point, 1));
      EXPECT_FALSE(FakeExperiments()(spec, point)->ReachesTolerance(merged));
    }
    return *journal->outcome;
  };
  double largest = 0;
  for (size_t point = 0; point < 5; ++point) {
    const Moments first = FakeMerged(WithTarget(5, {.tolerance = 1e-3}), point, 1).moments[0];
    largest = std::max(largest, *first.StandardError() / first.mean);
  }
  EXPECT_THAT(outcome_of(1, 0.99 * largest), StatusIs(absl::StatusCode::kDeadlineExceeded));
  EXPECT_OK(outcome_of(2, 1.01 * largest));
}

TEST_F(SchedulerTest, AReachedToleranceEndsBeforeTheBudget) {
  const EnsembleSpec spec = WithTarget(3, {.tolerance = 0.05, .budget_seconds = 1e6});
  const auto journal = Add(1, spec);
  TakeAllTurns();
  ASSERT_TRUE(journal->outcome);
  EXPECT_OK(*journal->outcome);
  ASSERT_EQ(journal->finished.size(), 3u);
  for (const auto& [point, merged] : journal->finished) {
    EXPECT_GT(merged.samples, 64u);  // more than one chunk
    EXPECT_LT(merged.samples, 1000 * kFakeSamplesPerBlock);
    EXPECT_TRUE(merged == FakeMerged(spec, point, merged.samples / kFakeSamplesPerBlock));
  }
}

// ---- several runs ----

// Each turn of the first run opens or finishes a point.
TEST_F(SchedulerTest, AWaitForTheDiskIsTimeOfTheRunWithResults) {
  for (const auto& [key, spec] : {std::pair(1, FakeSpec(100, 1)), {2, FakeSpec(1, 1000)}}) {
    Add(key, spec, [](RunRequest& request, RecordingJournal& journal) {
      journal.await_room = [] { return 0.02; };
      request.principal = std::to_string(request.key);
    });
  }
  EXPECT_LT(std::ranges::count(Turns(20, 1), 1), 5);
}

TEST_F(SchedulerTest, AHigherPriorityIsServedFirst) {
  for (const int32_t priority : {-7, 0, 7}) {
    Add(10 + priority, FakeSpec(2, 10),
        [&](RunRequest& request, RecordingJournal&) { request.priority = priority; });
  }
  std::vector<int64_t> runs = Turns(1000, 3);
  runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
  EXPECT_THAT(runs, ElementsAre(17, 10, 3));
}

// ---- executors elsewhere ----

TEST_F(SchedulerTest, AnEarlyChunkIsStoredAndAMergedOneIsInTheCheckpoint) {
  const auto journal = Opened(1, SixChunks());
  const std::vector<Lease> leases = TakeAllElsewhere();
  ASSERT_EQ(leases.size(), kChunks);
  EXPECT_OK(ReportAll(leases[2]));
  ASSERT_EQ(journal->early[0].size(), 1u);
  EXPECT_EQ(journal->early[0][0].chunk, 2u);
  EXPECT_TRUE(journal->checkpoints.empty());
  EXPECT_OK(ReportAll(leases[0]));
  EXPECT_EQ(journal->checkpoints[0].chunk, 1u);
  EXPECT_OK(ReportAll(leases[1]));
  EXPECT_EQ(journal->checkpoints[0].chunk, 3u);
  EXPECT_EQ(journal->early[0].size(), 1u);
}

TEST_F(SchedulerTest, ADamagedChunkIsRejectedAndTheOthersAreMerged) {
  constexpr uint64_t kMost = std::numeric_limits<uint64_t>::max();
  const std::vector<std::function<void(ChunkResult&)>> damages = {
      [](ChunkResult& chunk) {
        chunk.result.histograms.push_back({.lower = 0, .upper = 1, .counts = {0, 0}});
      },
      [](ChunkResult& chunk) { chunk.result.samples = kMost; },
      [](ChunkResult& chunk) { chunk.chunk = kChunks; },
      [](ChunkResult& chunk) { chunk.chunk = kMost; },
      [](ChunkResult& chunk) { chunk.result = {}; }};
  int64_t key = 0;
  for (const auto& damage : damages) {
    const auto journal = Opened(++key, SixChunks());
    const auto lease = TakeElsewhere(1000);
    ASSERT_TRUE(lease);
    std::vector<ChunkResult> chunks = ComputedChunks(*lease);
    const ChunkResult right = chunks[1];
    damage(chunks[1]);
    EXPECT_THAT(Report(*lease, chunks), StatusIs(absl::StatusCode::kDataLoss));
    EXPECT_EQ(journal->merged[0], 64u);
    EXPECT_OK(Report(*lease, {right}));
    ExpectComplete(SixChunks(), *journal);
  }
}

// A chunk with fewer samples than its merged blocks have.
TEST_F(SchedulerTest, AChunkThatContradictsItsMergedBlocksIsRefused) {
  const auto journal = Opened(1, SixChunks());
  const auto lost = TakeElsewhere();
  scheduler_.Return(*lost);
  ASSERT_TRUE(TakeTurn(10));
  ChunkResult damaged = ComputedChunks(*lost)[0];
  damaged.result.samples = 3;
  EXPECT_THAT(Report(*lost, {damaged}), StatusIs(absl::StatusCode::kDataLoss));
  EXPECT_EQ(journal->merged[0], 10 * kFakeSamplesPerBlock);
  TakeAllTurns();
  ExpectComplete(SixChunks(), *journal);
}

TEST_F(SchedulerTest, AnUntriedLeaseCountsNoAttempt) {
  Opened(1, SixChunks());
  for (int i = 0; i < 20; ++i) {
    const auto lease = TakeElsewhere();
    ASSERT_TRUE(lease);
    EXPECT_EQ(lease->start.chunk, 0u);
    EXPECT_EQ(lease->attempt, 1);
    scheduler_.Return(*lease, false);
  }
}

TEST_F(SchedulerTest, ASmallRunAndARunWithABudgetStayLocal) {
  const EnsembleSpec small = FakeSpec(1, 1400);  // 59 s
  const auto journal = Opened(1, small);
  EXPECT_FALSE(TakeElsewhere());
  TakeAllTurns();
  ExpectComplete(small, *journal);
  Opened(2, WithTarget(10, {.budget_seconds = 1e6}));
  EXPECT_FALSE(TakeElsewhere());
  scheduler_.Cancel(2);
  Opened(3, FakeSpec(1, 1440));  // 60.4 s
  EXPECT_TRUE(TakeElsewhere());
}

TEST_F(SchedulerTest, APointIsComputedBeforeTheNextOneIsOpened) {
  Opened(1, SixChunks(100));
  const auto next = Begin();
  ASSERT_TRUE(next);
  EXPECT_FALSE(next->OpensPoints());
  End(*next, 1);
}

TEST_F(SchedulerTest, AStoppedRunEndsWhenItsTurnsHaveEnded) {
  const auto journal = Opened(1, SixChunks(2));
  const auto elsewhere = TakeElsewhere();
  const auto here = Begin();
  ASSERT_TRUE(elsewhere && here);
  scheduler_.Cancel(1);
  EXPECT_TRUE(elsewhere->stop.stop_requested());
  EXPECT_TRUE(here->stop.stop_requested());
  EXPECT_FALSE(scheduler_.Needs(*elsewhere));
  EXPECT_EQ(journal->ends, 0);
  EXPECT_FALSE(TakeElsewhere());
  EXPECT_FALSE(Begin());
  End(*here, 1);
  EXPECT_EQ(journal->ends, 1);
  EXPECT_THAT(*journal->outcome, StatusIs(absl::StatusCode::kCancelled));
  EXPECT_OK(ReportAll(*elsewhere));
  scheduler_.Return(*elsewhere);
  EXPECT_EQ(journal->ends, 1);
}

TEST_F(SchedulerTest, AReportThatFailsEndsItsRun) {
  const auto journal = Opened(1, SixChunks());
  const auto lease = TakeElsewhere();
  ASSERT_TRUE(lease);
  journal->has_no_memory = true;
  EXPECT_OK(ReportAll(*lease));
  EXPECT_THAT(*journal->outcome, StatusIs(absl::StatusCode::kResourceExhausted));
}

// An earlier process gave the lease, and another job has the key now.
TEST_F(SchedulerTest, ReportsOfAnotherJobWithTheSameKeyAreDropped) {
  const auto journal = Opened(1, SixChunks());
  std::optional<Lease> other = TakeElsewhere();
  ASSERT_TRUE(other);
  other->generation = 7;
  EXPECT_OK(ReportAll(*other));
  EXPECT_TRUE(journal->merged.empty());
}

}  // namespace
}  // namespace ballpiston::server
