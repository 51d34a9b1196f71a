// Runs that were being computed when the process died are computed alone.
#include "tests/server/compute/stepped_scheduler.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

class SuspectsTest : public SchedulerTest {
 protected:
  Change Suspected(int64_t key, std::set<size_t> points = {}) {
    return [=, this](RunRequest& request, RecordingJournal&) {
      request.suspicion = {.points = points, .end = [this, key](bool is_refuted) {
                             if (disk_works_) (is_refuted ? cleared_ : undecided_).push_back(key);
                             return disk_works_;
                           }};
    };
  }

  bool disk_works_ = true;
  std::vector<int64_t> cleared_, undecided_;
};

// The first chunk of a point has 32 blocks.
TEST_F(SuspectsTest, SuspectsAreComputedAloneOneAfterTheOther) {
  const auto innocent = Add(1, SixChunks(2));
  const auto first = Add(2, SixChunks(2), Suspected(2));
  const auto second = Add(3, SixChunks(2), Suspected(3));
  EXPECT_THAT(Turns(3, 20), ElementsAre(2, 2, 2));  // opens a point, 20 blocks, the chunk
  EXPECT_THAT(cleared_, ElementsAre(2));
  EXPECT_THAT(Turns(3, 20), ElementsAre(3, 3, 3));
  EXPECT_THAT(cleared_, ElementsAre(2, 3));
  TakeAllTurns();
  for (const auto& journal : {innocent, first, second}) ExpectComplete(SixChunks(2), *journal);
  EXPECT_THAT(cleared_, ElementsAre(2, 3));
}

// Otherwise a crash that another run causes would count against the suspect.
TEST_F(SuspectsTest, ASuspectWaitsForTheEndOfTheOthersTurns) {
  Add(1, SixChunks(2));
  const auto turn = Begin();
  ASSERT_TRUE(turn);
  Add(2, SixChunks(2), Suspected(2));
  EXPECT_FALSE(Begin());
  End(*turn, 1);
  EXPECT_THAT(Turns(1, 1), ElementsAre(2));
}

// A suspicion ends when each point that was being computed has a chunk. Other points wait until
// then. A point that is already finished needs no chunk.
TEST_F(SuspectsTest, ASuspicionEndsWithAChunkOfEachComputedPoint) {
  Add(1, SixChunks(5));
  const auto suspect = Add(2, SixChunks(5), [this](RunRequest& request, RecordingJournal& journal) {
    Suspected(2, {0, 1, 3, 7})(request, journal);
    request.finished[0] = true;
  });
  EXPECT_THAT(Turns(2, 32), ElementsAre(2, 2));  // opens a point and computes a chunk
  EXPECT_THAT(cleared_, ElementsAre());
  EXPECT_THAT(Turns(2, 32), ElementsAre(2, 2));
  EXPECT_THAT(cleared_, ElementsAre(2));
  EXPECT_THAT(suspect->merged, UnorderedElementsAre(Pair(1, 64), Pair(3, 64)));
  TakeAllTurns();
  EXPECT_EQ(suspect->finished.size(), 4u);
}

TEST_F(SuspectsTest, ARunStaysASuspectWhileTheDiskFails) {
  Add(1, SixChunks(2));
  Add(2, SixChunks(2), Suspected(2));
  disk_works_ = false;
  EXPECT_THAT(Turns(4, 32), ElementsAre(2, 2, 2, 2));
  disk_works_ = true;
  EXPECT_THAT(Turns(1, 1), ElementsAre(2));
  EXPECT_THAT(Turns(1, 0), ElementsAre(1));
}

TEST_F(SuspectsTest, TheOthersGoOnAfterTwoMinutes) {
  Add(1, SixChunks(2));
  Add(2, SixChunks(2), Suspected(2));
  EXPECT_THAT(Turns(1, 1), ElementsAre(2));  // opens a point
  const auto turn = Begin();
  const auto beside_it = Begin();
  End(*turn, 1, 120);  // one of two parallel turns: counts as one minute
  End(*beside_it, 1, 59);
  EXPECT_THAT(undecided_, ElementsAre());
  End(*Begin(), 1, 2);
  EXPECT_THAT(undecided_, ElementsAre(2));
  EXPECT_THAT(cleared_, ElementsAre());
  EXPECT_THAT(Turns(1, 0), ElementsAre(1));
}

TEST_F(SuspectsTest, ACancelledSuspectLetsTheOthersGoOn) {
  const auto innocent = Add(1, SixChunks(2));
  const auto suspect = Add(2, SixChunks(2), Suspected(2));
  scheduler_.Cancel(2);
  EXPECT_EQ(suspect->ends, 1);
  TakeAllTurns();
  ExpectComplete(SixChunks(2), *innocent);
}

TEST_F(SuspectsTest, ExecutorsElsewherePause) {
  Opened(1, SixChunks(2));
  const auto lease = TakeElsewhere(10);
  ASSERT_TRUE(lease);
  Add(2, SixChunks(2), Suspected(2));
  EXPECT_FALSE(TakeElsewhere(10));
  EXPECT_THAT(ReportAll(*lease), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_THAT(Turns(2, 32), ElementsAre(2, 2));
  EXPECT_OK(ReportAll(*lease));
  EXPECT_TRUE(TakeElsewhere(10));
}

}  // namespace
}  // namespace ballpiston::server
