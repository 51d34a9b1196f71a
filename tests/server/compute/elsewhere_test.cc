// The scheduler with executors elsewhere: which leases they get, and which of their reports count.
// tests/core/ensemble/point_fold_test.cc and tests/simulation test that any order of reports gives
// the same bytes. The local executor takes its turns when the test says so, so every schedule can
// be repeated.
#include "server/compute/scheduler.h"
#include "tests/server/compute/remote_executor.h"
#include "tests/server/compute/run_requests.h"
#include "tests/server/compute/stepped_executor.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

// A capacity for one chunk, and for all chunks of a point.
constexpr double kOneChunk = 0;
constexpr double kWholePoint = 1000;

class Cluster {
 public:
  explicit Cluster(double seconds = kOneChunk) : remote(scheduler, seconds) {}
  ~Cluster() { scheduler.Shutdown(); }

  JournalPointer Add(const EnsembleSpec& spec, int64_t key = 1) {
    auto journal = std::make_shared<RecordingJournal>();
    scheduler.Add(RunOf(key, spec, journal));
    return journal;
  }

  // Adds a run and opens its first point.
  JournalPointer Begin(const EnsembleSpec& spec) {
    JournalPointer journal = Add(spec);
    EXPECT_TRUE(local.TakeTurn());
    return journal;
  }

  std::vector<Lease> TakeAll() {
    std::vector<Lease> leases;
    while (std::optional<Lease> lease = remote.Take()) leases.push_back(*std::move(lease));
    return leases;
  }

  FactoryOpener opener{FakeExperiments()};
  Scheduler scheduler{opener, 1};
  SteppedExecutor local{scheduler};
  RemoteExecutor remote;
};

void ExpectComplete(const EnsembleSpec& spec, const RecordingJournal& journal) {
  ASSERT_EQ(journal.ends, 1);
  EXPECT_OK(*journal.outcome);
  ExpectAllPointsRight(spec, journal);
  for (const auto& [point, samples] : journal.merged) {
    EXPECT_EQ(samples, journal.finished.at(point).samples) << "point " << point;
  }
}

// ---- reports ----

TEST(Scheduler, AChunkCountsOnceHoweverOftenItIsReported) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks(2));
  const std::vector<Lease> leases = cluster.TakeAll();
  ASSERT_EQ(leases.size(), kChunks);
  for (auto lease = leases.rbegin(); lease != leases.rend(); ++lease) {
    EXPECT_OK(cluster.remote.ReportAll(*lease));
    EXPECT_OK(cluster.remote.ReportAll(*lease));
    cluster.remote.Return(*lease);
    EXPECT_OK(cluster.remote.ReportAll(*lease));
    cluster.remote.Return(*lease);
  }
  EXPECT_EQ(journal->merged[0], 1500 * kFakeSamplesPerBlock);
  EXPECT_EQ(journal->finished.size(), 1u);
  cluster.local.TakeAllTurns();
  ExpectComplete(SixChunks(2), *journal);
}

TEST(Scheduler, AnEarlyChunkIsStoredAndAMergedOneIsInTheCheckpoint) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks());
  const std::vector<Lease> leases = cluster.TakeAll();
  ASSERT_EQ(leases.size(), kChunks);
  EXPECT_OK(cluster.remote.ReportAll(leases[2]));
  ASSERT_EQ(journal->early[0].size(), 1u);
  EXPECT_EQ(journal->early[0][0].chunk, 2u);
  EXPECT_TRUE(journal->checkpoints.empty());
  EXPECT_OK(cluster.remote.ReportAll(leases[0]));
  EXPECT_EQ(journal->checkpoints[0].chunk, 1u);
  EXPECT_OK(cluster.remote.ReportAll(leases[1]));
  EXPECT_EQ(journal->checkpoints[0].chunk, 3u);
  EXPECT_EQ(journal->early[0].size(), 1u);
}

TEST(Scheduler, ADamagedChunkIsRejectedAndTheOthersAreMerged) {
  const auto damages = {
      +[](const ChunkResult& chunk) { return WithAnotherHistogram(chunk); },
      +[](const ChunkResult& chunk) { return WithTooManySamples(chunk); },
      +[](const ChunkResult& chunk) { return WithNumber(chunk, kChunks); },
      +[](const ChunkResult& chunk) {
        return WithNumber(chunk, std::numeric_limits<uint64_t>::max());
      },
      +[](const ChunkResult& chunk) { return ChunkResult{.chunk = chunk.chunk}; }};
  for (const auto damage : damages) {
    Cluster cluster(kWholePoint);
    const auto journal = cluster.Begin(SixChunks());
    const auto lease = cluster.remote.Take();
    ASSERT_TRUE(lease);
    std::vector<ChunkResult> chunks = ComputedChunks(*lease);
    const ChunkResult right = std::exchange(chunks[1], damage(chunks[1]));
    EXPECT_THAT(cluster.remote.Report(*lease, chunks), StatusIs(absl::StatusCode::kDataLoss));
    EXPECT_EQ(journal->merged[0], 64u);
    EXPECT_OK(cluster.remote.Report(*lease, {right}));
    ExpectComplete(SixChunks(), *journal);
  }
}

// A chunk with fewer samples than its merged blocks have.
TEST(Scheduler, AChunkThatContradictsItsMergedBlocksIsRefused) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks());
  const auto lost = cluster.remote.Take();
  cluster.remote.Return(*lost);
  ASSERT_TRUE(cluster.local.TakeTurn(10));
  ChunkResult damaged = ComputedChunks(*lost)[0];
  damaged.result.samples = 3;
  EXPECT_THAT(cluster.remote.Report(*lost, {damaged}), StatusIs(absl::StatusCode::kDataLoss));
  EXPECT_EQ(journal->merged[0], 10 * kFakeSamplesPerBlock);
  cluster.local.TakeAllTurns();
  ExpectComplete(SixChunks(), *journal);
}

// ---- leases ----

TEST(Scheduler, AnUntriedLeaseCountsNoAttempt) {
  Cluster cluster;
  cluster.Begin(SixChunks());
  for (int i = 0; i < 20; ++i) {
    const auto lease = cluster.remote.Take();
    ASSERT_TRUE(lease);
    EXPECT_EQ(lease->start.chunk, 0u);
    EXPECT_EQ(lease->attempt, 1);
    cluster.remote.Return(*lease, false);
  }
}

TEST(Scheduler, ASmallRunAndARunWithABudgetStayLocal) {
  Cluster cluster;
  const EnsembleSpec spec = FakeSpec(1, 1400);  // 59 s
  const auto journal = cluster.Begin(spec);
  EXPECT_FALSE(cluster.remote.Take());
  cluster.local.TakeAllTurns();
  ExpectComplete(spec, *journal);
  const auto large = cluster.Add(FakeSpec(1, 1440), 2);  // 60.4 s
  cluster.local.TakeTurn();
  EXPECT_TRUE(cluster.remote.Take());
  Cluster other;
  EnsembleSpec budget = SixChunks(10);
  budget.target = {.budget_seconds = 1e6};
  other.Begin(budget);
  EXPECT_FALSE(other.remote.Take());
}

// Without the hungry executor the local one computes a point before it opens the next one.
TEST(Scheduler, PointsAreOpenedAheadForAHungryExecutorElsewhere) {
  for (const bool is_hungry : {false, true}) {
    Cluster cluster(kWholePoint);
    cluster.Begin(SixChunks(100));
    if (is_hungry) {
      EXPECT_EQ(cluster.TakeAll().size(), 1u);
      ASSERT_TRUE(cluster.local.TakeTurn());
      EXPECT_EQ(cluster.TakeAll().size(), 32u);
    } else {
      const auto next = cluster.local.Begin();
      ASSERT_TRUE(next);
      EXPECT_FALSE(next->OpensPoints());
      cluster.local.End(*next, 1);
    }
  }
}

TEST(Scheduler, WorkElsewhereIsChargedToItsRun) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks());
  const auto lease = cluster.remote.Take();
  ASSERT_TRUE(lease);
  EXPECT_OK(cluster.remote.Report(*lease, {}, 3));
  EXPECT_OK(cluster.remote.Report(*lease, ComputedChunks(*lease), 4));
  EXPECT_EQ(journal->work, 7);
  EXPECT_EQ(cluster.scheduler.Counts().processor_seconds, 7);
  cluster.remote.Return(*lease);
  EXPECT_EQ(journal->work, 7);
}

// ---- the end ----

TEST(Scheduler, AStoppedRunEndsWhenItsTurnsHaveEnded) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks(2));
  const auto elsewhere = cluster.remote.Take();
  const auto here = cluster.local.Begin();
  ASSERT_TRUE(elsewhere && here);
  cluster.scheduler.Cancel(1);
  EXPECT_TRUE(elsewhere->stop.stop_requested());
  EXPECT_TRUE(here->stop.stop_requested());
  EXPECT_FALSE(cluster.scheduler.Needs(*elsewhere));
  EXPECT_EQ(journal->ends, 0);
  EXPECT_FALSE(cluster.remote.Take());
  EXPECT_FALSE(cluster.local.Begin());
  cluster.local.End(*here, 1);
  EXPECT_EQ(journal->ends, 1);
  EXPECT_THAT(*journal->outcome, StatusIs(absl::StatusCode::kCancelled));
  EXPECT_OK(cluster.remote.ReportAll(*elsewhere));
  cluster.remote.Return(*elsewhere);
  EXPECT_EQ(journal->ends, 1);
}

// An earlier process gave the lease, and another job has the key now.
TEST(Scheduler, ReportsOfAnotherJobWithTheSameKeyAreDropped) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks());
  std::optional<Lease> other = cluster.remote.Take();
  ASSERT_TRUE(other);
  other->generation = 7;
  EXPECT_OK(cluster.remote.ReportAll(*other));
  EXPECT_TRUE(journal->merged.empty());
}

}  // namespace
}  // namespace ballpiston::server
