// Runs that were being computed when the process died are computed alone.
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/scheduling/scheduler.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/scheduling/fake_pilots.h"
#include "tests/server/scheduling/recording_journal.h"
#include "tests/server/scheduling/remote_executor.h"
#include "tests/server/scheduling/run_requests.h"
#include "tests/server/scheduling/stepped_executor.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;

class SuspectsTest : public testing::Test {
 protected:
  JournalPointer Add(int64_t key, std::optional<Suspicion> suspicion = {},
                     const EnsembleSpec& spec = SixChunks(2)) {
    auto journal = std::make_shared<RecordingJournal>();
    RunRequest request = RunOf(key, spec, journal);
    request.suspicion = std::move(suspicion);
    scheduler_.Add(std::move(request));
    return journal;
  }

  Suspicion Suspected(int64_t key, std::set<size_t> points = {}) {
    return {.points = std::move(points), .clear = [this, key] {
              if (disk_works_) cleared_.push_back(key);
              return disk_works_;
            }};
  }

  // The runs of the next turns, in order; each turn computes so many blocks.
  std::vector<int64_t> Turns(int turns, uint64_t blocks) {
    std::vector<int64_t> runs;
    for (int turn = 0; turn < turns; ++turn) {
      const auto lease = local_.Begin();
      if (!lease) break;
      runs.push_back(lease->run);
      local_.End(*lease, blocks);
    }
    return runs;
  }

  FactoryOpener opener_{FakeExperiments()};
  Scheduler scheduler_{opener_, 1};
  SteppedExecutor local_{scheduler_};
  bool disk_works_ = true;
  std::vector<int64_t> cleared_;
};

// The first chunk of a point has 32 blocks.
TEST_F(SuspectsTest, SuspectsAreComputedAloneOneAfterTheOther) {
  const auto innocent = Add(1), first = Add(2, Suspected(2)), second = Add(3, Suspected(3));
  EXPECT_THAT(Turns(3, 20), ElementsAre(2, 2, 2));  // opens a point, 20 blocks, the chunk
  EXPECT_THAT(cleared_, ElementsAre(2));
  EXPECT_THAT(Turns(3, 20), ElementsAre(3, 3, 3));
  EXPECT_THAT(cleared_, ElementsAre(2, 3));
  local_.TakeAllTurns();
  for (const auto& journal : {innocent, first, second}) {
    ASSERT_EQ(journal->ends, 1);
    ExpectAllPointsRight(SixChunks(2), *journal);
  }
  EXPECT_THAT(cleared_, ElementsAre(2, 3));
}

// Another point's chunk proves nothing.
TEST_F(SuspectsTest, TheChunkIsOfThePointsThatWereBeingComputed) {
  Add(1);
  Add(2, Suspected(2, {1}));
  EXPECT_THAT(Turns(1, 0), ElementsAre(2));     // opens the first point
  EXPECT_THAT(Turns(1, 1500), ElementsAre(2));  // all of it
  EXPECT_THAT(Turns(2, 32), ElementsAre(2, 2));
  EXPECT_THAT(cleared_, ElementsAre(2));
}

TEST_F(SuspectsTest, TheChunkIsInACheckpointBeforeTheRunIsCleared) {
  JournalPointer journal;
  uint64_t stored_chunks = 0;
  journal = Add(2, Suspicion{.points = {0}, .clear = [&] {
                               stored_chunks = journal->checkpoints.at(0).chunk;
                               return true;
                             }});
  EXPECT_THAT(Turns(2, 31), ElementsAre(2, 2));
  EXPECT_TRUE(journal->checkpoints.empty());
  EXPECT_EQ(stored_chunks, 0u);
  EXPECT_THAT(Turns(1, 1), ElementsAre(2));
  EXPECT_EQ(stored_chunks, 1u);
}

TEST_F(SuspectsTest, ARunStaysASuspectWhileTheDiskFails) {
  Add(1);
  Add(2, Suspected(2));
  disk_works_ = false;
  EXPECT_THAT(Turns(4, 32), ElementsAre(2, 2, 2, 2));
  disk_works_ = true;
  EXPECT_THAT(Turns(1, 1), ElementsAre(2));
  EXPECT_THAT(Turns(1, 0), ElementsAre(1));
}

TEST_F(SuspectsTest, TheNextSuspectWaitsForTheTurnsOfOthers) {
  SteppedExecutor other(scheduler_);
  Add(1, Suspected(1));
  Add(2, Suspected(2));
  ASSERT_THAT(Turns(1, 0), ElementsAre(1));
  const auto slow = other.Begin();
  ASSERT_TRUE(slow);
  EXPECT_EQ(slow->run, 1);
  ASSERT_THAT(Turns(2, 1500), ElementsAre(1, 1));  // opens the next point and computes it
  EXPECT_THAT(cleared_, ElementsAre(1));
  EXPECT_FALSE(local_.Begin());
  other.End(*slow, 1);
  EXPECT_THAT(Turns(1, 0), ElementsAre(2));
}

TEST_F(SuspectsTest, ACancelledSuspectLetsTheOthersGoOn) {
  const auto innocent = Add(1), suspect = Add(2, Suspected(2));
  scheduler_.Cancel(2);
  EXPECT_EQ(suspect->ends, 1);
  local_.TakeAllTurns();
  ExpectAllPointsRight(SixChunks(2), *innocent);
}

TEST_F(SuspectsTest, PointsThatAreFinishedNeedNoChunk) {
  Add(1);
  auto journal = std::make_shared<RecordingJournal>();
  RunRequest request = RunOf(2, SixChunks(2), journal);
  request.finished[0] = true;
  request.suspicion = Suspected(2, {0, 7});
  scheduler_.Add(std::move(request));
  ASSERT_THAT(Turns(2, 32), ElementsAre(2, 2));
  EXPECT_THAT(cleared_, ElementsAre(2));
}

TEST_F(SuspectsTest, APointWithoutSamplesIsProgress) {
  EnsembleSpec closed = FakeSpec(300, 0);
  Add(1, {}, closed);
  Add(2, Suspected(2, {0}), closed);
  EXPECT_THAT(Turns(1, 0), ElementsAre(2));
  EXPECT_THAT(cleared_, ElementsAre(2));
}

// The first suspect is paused while it computes a pilot that the second needs.
TEST_F(SuspectsTest, TheNextSuspectTakesAPilotOver) {
  FakePilotOpener opener([](const EnsembleSpec&, size_t index) {
    return index == 1 ? std::optional(PilotPlace{.rho = 0.53, .delta = 0.1}) : std::nullopt;
  });
  Scheduler scheduler(opener, 2);
  SteppedExecutor local(scheduler), other(scheduler);
  EnsembleSpec spec = FakeSpec(2, 10);
  spec.model = Model::kBilliard;  // a lease opens one point
  std::vector<JournalPointer> journals;
  for (const int64_t key : {1, 2}) {
    journals.push_back(std::make_shared<RecordingJournal>());
    RunRequest request = RunOf(key, spec, journals.back());
    request.suspicion = Suspected(key, {0});
    scheduler.Add(std::move(request));
  }
  ASSERT_TRUE(local.TakeTurn());  // opens the first point
  const auto lease = local.Begin();
  ASSERT_TRUE(lease);
  ASSERT_TRUE(other.TakeTurn());   // opens the second point: it needs the pilot
  ASSERT_TRUE(other.TakeTurn(1));  // the pilot begins
  local.End(*lease, 10);
  EXPECT_THAT(cleared_, ElementsAre(1));
  local.TakeAllTurns();
  other.TakeAllTurns();
  EXPECT_THAT(cleared_, ElementsAre(1, 2));
  local.TakeAllTurns();
  for (const auto& journal : journals) {
    ASSERT_EQ(journal->ends, 1);
    ExpectAllPointsRight(spec, *journal);
  }
}

TEST_F(SuspectsTest, ExecutorsElsewherePause) {
  RemoteExecutor remote(scheduler_);
  const auto innocent = Add(1);
  ASSERT_THAT(Turns(1, 0), ElementsAre(1));
  const auto lease = remote.Take();
  ASSERT_TRUE(lease);
  Add(2, Suspected(2));
  EXPECT_FALSE(remote.Take());
  EXPECT_THAT(remote.ReportAll(*lease), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_THAT(Turns(2, 32), ElementsAre(2, 2));
  EXPECT_OK(remote.ReportAll(*lease));
  EXPECT_TRUE(remote.Take());
}

}  // namespace
}  // namespace ballpiston::server
