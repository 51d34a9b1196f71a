// The scheduler with executors elsewhere: which leases they get, and how their reports are merged.
// The local executor takes its turns when the test says so, so every schedule can be repeated.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/compute/scheduler.h"
#include "tests/server/compute/recording_journal.h"
#include "tests/server/compute/remote_executor.h"
#include "tests/server/compute/run_requests.h"
#include "tests/server/compute/stepped_executor.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

// A capacity for one chunk, and for all chunks of a point.
constexpr double kOneChunk = 0;
constexpr double kWholePoint = 1000;

class Cluster {
 public:
  explicit Cluster(double seconds = kOneChunk, double longest_chunk = kInfinity)
      : opener_(FakeExperiments()),
        scheduler(opener_, 1),
        local(scheduler),
        remote(scheduler, seconds, longest_chunk) {}
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

 private:
  FactoryOpener opener_;

 public:
  Scheduler scheduler;
  SteppedExecutor local;
  RemoteExecutor remote;
};

void ExpectComplete(const EnsembleSpec& spec, const RecordingJournal& journal) {
  ASSERT_EQ(journal.ends, 1);
  EXPECT_OK(*journal.outcome);
  ExpectAllPointsRight(spec, journal);
  for (const auto& [point, samples] : journal.merged) {
    const auto before = journal.restored.find(point);
    const uint64_t restored = before == journal.restored.end() ? 0 : before->second;
    EXPECT_EQ(samples + restored, journal.finished.at(point).samples) << "point " << point;
  }
}

// ---- reports ----

TEST(Scheduler, TheSameBitsForEveryOrderOfReports) {
  std::vector<size_t> order(kChunks);
  std::iota(order.begin(), order.end(), 0);
  std::vector<ChunkResult> computed;
  do {
    Cluster cluster;
    const auto journal = cluster.Begin(SixChunks());
    const std::vector<Lease> leases = cluster.TakeAll();
    ASSERT_EQ(leases.size(), kChunks);
    if (computed.empty()) {
      for (const Lease& lease : leases) computed.push_back(ComputedChunks(lease)[0]);
    }
    for (const size_t chunk : order) {
      EXPECT_OK(cluster.remote.Report(leases[chunk], {computed[chunk]}));
    }
    ExpectComplete(SixChunks(), *journal);
    if (testing::Test::HasFailure()) break;
  } while (std::next_permutation(order.begin(), order.end()));
}

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

// The local executor has merged some blocks of the chunk when it comes whole from elsewhere.
TEST(Scheduler, AChunkCountsOnceBesideItsMergedBlocks) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks());
  const auto lost = cluster.remote.Take();
  ASSERT_TRUE(lost);
  cluster.remote.Return(*lost);
  ASSERT_TRUE(cluster.local.TakeTurn(10));
  EXPECT_EQ(journal->merged[0], 10 * kFakeSamplesPerBlock);
  EXPECT_OK(cluster.remote.ReportAll(*lost));
  EXPECT_EQ(journal->merged[0], 64u);
  cluster.local.TakeAllTurns();
  ExpectComplete(SixChunks(), *journal);
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

TEST(Scheduler, APartialChunkFromElsewhereIsDropped) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks());
  const auto lease = cluster.remote.Take();
  ASSERT_TRUE(lease);
  const ChunkResult damaged = WithAnotherHistogram(ComputedChunks(*lease)[0]);
  EXPECT_OK(cluster.scheduler.Report(
      *lease, {.partial = {.chunk = 0, .blocks = 1, .merged = damaged.result}}));
  EXPECT_TRUE(journal->merged.empty());
  EXPECT_OK(cluster.remote.ReportAll(*lease));
  cluster.local.TakeAllTurns();
  for (const Lease& rest : cluster.TakeAll()) EXPECT_OK(cluster.remote.ReportAll(rest));
  cluster.local.TakeAllTurns();
  ExpectComplete(SixChunks(), *journal);
}

// Valid chunks of the point that belong to another lease are merged and not computed again.
TEST(Scheduler, AChunkOutsideItsLeaseIsMerged) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks());
  const auto lease = cluster.remote.Take();
  ASSERT_TRUE(lease);
  Lease whole = *lease;
  whole.end = kChunks;
  EXPECT_OK(cluster.remote.Report(*lease, ComputedChunks(whole)));
  ExpectComplete(SixChunks(), *journal);
  EXPECT_FALSE(cluster.remote.Take());
}

TEST(Scheduler, ReportsOfUnknownRunsAndFinishedPointsAreDropped) {
  Cluster cluster(kWholePoint);
  const auto journal = cluster.Begin(SixChunks());
  const auto lease = cluster.remote.Take();
  ASSERT_TRUE(lease);
  EXPECT_TRUE(cluster.scheduler.Needs(*lease));
  EXPECT_OK(cluster.remote.ReportAll(*lease));
  EXPECT_FALSE(cluster.scheduler.Needs(*lease));
  EXPECT_TRUE(lease->stop.stop_requested());
  EXPECT_OK(cluster.remote.ReportAll(*lease));
  cluster.remote.Return(*lease);
  ExpectComplete(SixChunks(), *journal);
}

// ---- leases ----

TEST(Scheduler, ReturnedChunksGoOutAgain) {
  for (const bool tried : {true, false}) {
    Cluster cluster(kWholePoint);
    const auto journal = cluster.Begin(SixChunks());
    const auto lease = cluster.remote.Take();
    ASSERT_TRUE(lease);
    std::vector<ChunkResult> chunks = ComputedChunks(*lease);
    EXPECT_OK(cluster.remote.Report(*lease, {chunks[0], chunks[3]}));
    EXPECT_FALSE(cluster.remote.Take());
    cluster.remote.Return(*lease, tried);
    EXPECT_FALSE(cluster.scheduler.Needs(*lease));
    // What is left is too small for an executor elsewhere if it is the whole run.
    cluster.Add(SixChunks(), 2);
    std::vector<std::pair<uint64_t, uint64_t>> again;
    while (const auto next = cluster.local.Begin()) {
      if (!next->OpensPoints() && next->run == 1) {
        again.emplace_back(next->start.chunk, next->end);
        EXPECT_EQ(next->attempt, tried ? 2 : 1);
      }
      cluster.local.End(*next, 1'000'000);
    }
    EXPECT_THAT(again, testing::ElementsAre(std::pair(1, 3), std::pair(4, 6)));
    ExpectComplete(SixChunks(), *journal);
  }
}

TEST(Scheduler, AChunkStaysLocalAfterFiveAttempts) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks());
  for (int attempt = 1; attempt <= 5; ++attempt) {
    const auto lease = cluster.remote.Take();
    ASSERT_TRUE(lease);
    EXPECT_EQ(lease->start.chunk, 0u);
    EXPECT_EQ(lease->attempt, attempt);
    cluster.remote.Return(*lease);
  }
  for (const Lease& lease : cluster.TakeAll()) {
    EXPECT_GT(lease.start.chunk, 0u);
    EXPECT_OK(cluster.remote.ReportAll(lease));
  }
  const auto last = cluster.local.Begin();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->start.chunk, 0u);
  EXPECT_EQ(last->end, 1u);
  EXPECT_EQ(last->attempt, 6);
  cluster.local.End(*last, 1000);
  ExpectComplete(SixChunks(), *journal);
}

// Another executor has the chunks by then.
TEST(Scheduler, ASecondReturnHasNoEffect) {
  Cluster cluster(kWholePoint);
  cluster.Begin(SixChunks());
  const auto first = cluster.remote.Take();
  ASSERT_TRUE(first);
  cluster.remote.Return(*first);
  ASSERT_TRUE(cluster.remote.Take());
  cluster.remote.Return(*first);
  EXPECT_FALSE(cluster.remote.Take());
}

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

TEST(Scheduler, ARunTooSmallForElsewhereStaysLocal) {
  Cluster cluster;
  const EnsembleSpec spec = FakeSpec(1, 1400);  // 59 s
  const auto journal = cluster.Begin(spec);
  EXPECT_FALSE(cluster.remote.Take());
  cluster.local.TakeAllTurns();
  ExpectComplete(spec, *journal);
  const auto large = cluster.Add(FakeSpec(1, 1440), 2);  // 60.4 s
  cluster.local.TakeTurn();
  EXPECT_TRUE(cluster.remote.Take());
}

TEST(Scheduler, TheRestOfARunStaysLocalIfItIsTooSmallForElsewhere) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks());
  const auto first = cluster.remote.Take(), second = cluster.remote.Take();
  ASSERT_TRUE(first && second);
  EXPECT_OK(cluster.remote.ReportAll(*first));
  EXPECT_OK(cluster.remote.ReportAll(*second));
  EXPECT_FALSE(cluster.remote.Take());  // 59 s are left
  cluster.local.TakeAllTurns();
  ExpectComplete(SixChunks(), *journal);
}

TEST(Scheduler, ARunWithABudgetStaysLocal) {
  Cluster cluster;
  EnsembleSpec spec = SixChunks(10);
  spec.target = {.budget_seconds = 1e6};
  cluster.Begin(spec);
  EXPECT_FALSE(cluster.remote.Take());
}

TEST(Scheduler, AChunkLongerThanTheLongestStaysLocal) {
  Cluster cluster(kWholePoint, 15);  // chunk 3 takes 10.7 s, chunk 4 takes 21.5 s
  const auto journal = cluster.Begin(SixChunks());
  const std::vector<Lease> leases = cluster.TakeAll();
  ASSERT_EQ(leases.size(), 1u);
  EXPECT_EQ(leases[0].start.chunk, 0u);
  EXPECT_EQ(leases[0].end, 4u);
  cluster.local.TakeAllTurns();
  EXPECT_EQ(journal->ends, 0);
  EXPECT_OK(cluster.remote.ReportAll(leases[0]));
  ExpectComplete(SixChunks(), *journal);
}

TEST(Scheduler, AnInfiniteCapacityElsewhereRespectsTheLongestChunk) {
  Cluster cluster(kInfinity, 15);
  cluster.Begin(SixChunks());
  const auto lease = cluster.remote.Take();
  ASSERT_TRUE(lease);
  EXPECT_EQ(lease->end, 4u);
  EXPECT_GT(lease->seconds, 0);
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

// Only so many wait: the local executor then computes chunks itself.
TEST(Scheduler, AHungryExecutorDoesNotDelayOthers) {
  Cluster cluster(kWholePoint);
  const EnsembleSpec spec = SixChunks(3000);
  cluster.Begin(spec);
  cluster.TakeAll();  // now it is hungry, and requests no more leases
  size_t opened = 1;
  while (const auto lease = cluster.local.Begin()) {
    opened += lease->opens.size();
    const bool computes = !lease->OpensPoints();
    cluster.local.End(*lease, 1);
    if (computes) break;
  }
  EXPECT_GE(opened, 2000u);
  EXPECT_LT(opened, 2100u);
}

// The next chunk beyond the expected end can be leased when the chunks before it are merged. The
// idle executors must be woken, even if the executor elsewhere takes no more.
TEST(Scheduler, AReportFromElsewhereWakesTheExecutors) {
  Cluster cluster(kWholePoint);
  RemoteExecutor waiting(cluster.scheduler);
  cluster.Begin(SixChunks(2));
  const auto lease = cluster.remote.Take();
  ASSERT_TRUE(lease);
  const int wakes = waiting.wakes();
  EXPECT_OK(cluster.remote.Report(*lease, {ComputedChunks(*lease)[0]}));
  EXPECT_GT(waiting.wakes(), wakes);
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

TEST(Scheduler, AStoppedRunDoesNotWaitForExecutorsElsewhere) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks());
  const auto lease = cluster.remote.Take();
  ASSERT_TRUE(lease);
  const int wakes = cluster.remote.wakes();
  cluster.scheduler.Cancel(1);
  EXPECT_EQ(journal->ends, 1);
  EXPECT_GT(cluster.remote.wakes(), wakes);
  EXPECT_TRUE(lease->stop.stop_requested());
}

TEST(Scheduler, ARunThatFailsElsewhereEnds) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks());
  const auto lease = cluster.remote.Take();
  ASSERT_TRUE(lease);
  const int wakes = cluster.remote.wakes();
  cluster.remote.Fail(*lease, absl::InternalError("the task failed"));
  ASSERT_EQ(journal->ends, 1);
  EXPECT_THAT(*journal->outcome, StatusIs(absl::StatusCode::kInternal, "the task failed"));
  EXPECT_FALSE(cluster.scheduler.Needs(*lease));
  EXPECT_GT(cluster.remote.wakes(), wakes);
}

TEST(Scheduler, NoLeaseIsGivenAfterTheShutdown) {
  Cluster cluster;
  const auto journal = cluster.Begin(SixChunks(2));
  const auto lease = cluster.remote.Take();
  ASSERT_TRUE(lease);
  cluster.scheduler.Shutdown();
  EXPECT_TRUE(lease->stop.stop_requested());
  EXPECT_TRUE(cluster.remote.is_shut_down());
  cluster.Add(SixChunks(), 2);
  EXPECT_FALSE(cluster.scheduler.Next({.executor = cluster.remote.number()}));
  EXPECT_FALSE(cluster.scheduler.Next({.executor = 0}));
  EXPECT_EQ(journal->ends, 0);
}

// ---- leases of an earlier process ----

Lease EarlierLease(const Cluster& cluster, uint64_t first, uint64_t end, size_t point = 0) {
  Lease lease;
  lease.run = 1;
  lease.executor = cluster.remote.number();
  lease.point = point;
  lease.start.chunk = first;
  lease.end = end;
  return lease;
}

absl::Status ReportEarlier(Cluster& cluster, const Lease& lease, const EnsembleSpec& spec) {
  const auto experiment = FakeExperiments()(spec, lease.point);
  return cluster.remote.Report(lease, ComputedChunks(lease, *experiment));
}

TEST(Scheduler, ChunksOfAnEarlierProcessAreMerged) {
  Cluster cluster(kWholePoint);
  const auto journal = cluster.Begin(SixChunks());
  EXPECT_OK(ReportEarlier(cluster, EarlierLease(cluster, 1, 3), SixChunks()));
  const std::vector<Lease> leases = cluster.TakeAll();
  ASSERT_EQ(leases.size(), 2u);
  EXPECT_EQ(leases[0].end, 1u);
  EXPECT_EQ(leases[1].start.chunk, 3u);
  for (const Lease& lease : leases) EXPECT_OK(cluster.remote.ReportAll(lease));
  ExpectComplete(SixChunks(), *journal);
}

TEST(Scheduler, AReportWaitsUntilItsPointIsOpen) {
  Cluster cluster(kWholePoint);
  const auto journal = cluster.Add(SixChunks(3));
  const Lease earlier = EarlierLease(cluster, 2, 4, 2);
  EXPECT_THAT(ReportEarlier(cluster, earlier, SixChunks(3)),
              StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_TRUE(journal->early.empty());
  while (absl::IsUnavailable(ReportEarlier(cluster, earlier, SixChunks(3)))) {
    ASSERT_TRUE(cluster.local.TakeTurn());
  }
  EXPECT_EQ(journal->early[2].size(), 2u);
  cluster.local.TakeAllTurns();
  ExpectComplete(SixChunks(3), *journal);
  EXPECT_OK(ReportEarlier(cluster, earlier, SixChunks(3)));
}

TEST(Scheduler, ReportsOfAnotherJobWithTheSameKeyAreDropped) {
  Cluster cluster(kWholePoint);
  const auto journal = cluster.Begin(SixChunks());
  Lease other = EarlierLease(cluster, 0, 1);
  other.generation = 7;
  EXPECT_OK(ReportEarlier(cluster, other, SixChunks()));
  EXPECT_TRUE(journal->merged.empty());
}

TEST(Scheduler, ReportsOfFinishedPointsOfAnEarlierProcessAreDropped) {
  Cluster cluster;
  const auto journal = std::make_shared<RecordingJournal>();
  RunRequest request = RunOf(1, SixChunks(2), journal);
  request.finished = {true, false};
  cluster.scheduler.Add(std::move(request));
  EXPECT_OK(ReportEarlier(cluster, EarlierLease(cluster, 0, 1, 0), SixChunks(2)));
  Lease beyond = EarlierLease(cluster, 0, 1, 0);
  beyond.point = 7;
  EXPECT_OK(cluster.remote.Report(beyond, {}));
  cluster.scheduler.Cancel(1);
  EXPECT_OK(ReportEarlier(cluster, EarlierLease(cluster, 0, 1, 1), SixChunks(2)));
}

}  // namespace
}  // namespace ballpiston::server
