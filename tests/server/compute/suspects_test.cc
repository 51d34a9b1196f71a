// Runs that were being computed when the process died are computed alone.
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "server/compute/scheduler.h"
#include "tests/server/compute/fake_pilots.h"
#include "tests/server/compute/recording_journal.h"
#include "tests/server/compute/remote_executor.h"
#include "tests/server/compute/run_requests.h"
#include "tests/server/compute/stepped_executor.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

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

// Another point's chunk proves nothing, so other points wait.
TEST_F(SuspectsTest, TheChunksAreOfThePointsThatWereBeingComputed) {
  Add(1, {}, SixChunks(5));
  const auto suspect = Add(2, Suspected(2, {1, 3}), SixChunks(5));
  EXPECT_THAT(Turns(2, 32), ElementsAre(2, 2));  // opens a point and computes a chunk
  EXPECT_THAT(cleared_, ElementsAre());
  EXPECT_THAT(Turns(2, 32), ElementsAre(2, 2));
  EXPECT_THAT(cleared_, ElementsAre(2));
  EXPECT_THAT(suspect->merged, UnorderedElementsAre(Pair(1, 64), Pair(3, 64)));
  local_.TakeAllTurns();
  ExpectAllPointsRight(SixChunks(5), *suspect);
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
  request.suspicion = Suspected(2, {0, 2, 7});
  scheduler_.Add(std::move(request));
  ASSERT_THAT(Turns(2, 32), ElementsAre(2, 2));
  EXPECT_THAT(cleared_, ElementsAre(2));
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
