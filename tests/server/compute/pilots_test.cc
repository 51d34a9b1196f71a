// Pilots in the scheduler: which run computes a pilot, which runs wait for it, and which run is
// charged.
#include "server/compute/scheduler.h"
#include "server/compute/thread_executor.h"
#include "tests/server/compute/fake_pilots.h"
#include "tests/server/compute/remote_executor.h"
#include "tests/server/compute/run_requests.h"
#include "tests/server/compute/stepped_executor.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

const PilotPlace kPlace = {.rho = 0.53, .delta = 0.1};

// Runs with a seed below this need the pilot at kPlace, the others none.
constexpr uint64_t kFirstSeedWithoutPilot = 100;

std::optional<PilotPlace> OnePlace(const EnsembleSpec& spec, size_t) {
  return spec.seed < kFirstSeedWithoutPilot ? std::optional(kPlace) : std::nullopt;
}

// A pilot takes 200 blocks; a turn here computes 64.
constexpr uint64_t kBlocksOfATurn = 64;

class PilotsTest : public testing::Test {
 protected:
  PilotsTest() : opener_(OnePlace), scheduler_(opener_, 1), local_(scheduler_) {}
  ~PilotsTest() override { scheduler_.Shutdown(); }

  // One point of 10 blocks. Runs of one principal take turns.
  JournalPointer Add(int64_t key, uint64_t seed) {
    auto journal = std::make_shared<RecordingJournal>();
    scheduler_.Add(RunOf(key, SpecOf(seed), journal));
    return journal;
  }
  static EnsembleSpec SpecOf(uint64_t seed) { return FakeSpec(2, 10, seed); }

  // Takes turns of some blocks until the pilot has begun, and returns the run that computes it.
  int64_t BeginPilot() {
    while (const std::optional<Lease> lease = local_.Begin()) {
      local_.End(*lease, 1);
      if (lease->pilot) return lease->run;
    }
    return 0;
  }

  void ExpectRight(const RecordingJournal& journal, uint64_t seed) {
    ASSERT_EQ(journal.ends, 1);
    EXPECT_OK(*journal.outcome);
    ExpectAllPointsRight(SpecOf(seed), journal);
  }

  FakePilotOpener opener_;
  Scheduler scheduler_;
  SteppedExecutor local_;
};

TEST_F(PilotsTest, APilotIsComputedOnceForAllRuns) {
  const auto first = Add(1, 1), second = Add(2, 2), third = Add(3, 3);
  while (local_.TakeTurn(kBlocksOfATurn)) {
  }
  ExpectRight(*first, 1);
  ExpectRight(*second, 2);
  ExpectRight(*third, 3);
  EXPECT_EQ(opener_.opened(), 1);
  const auto kept = opener_.kept();
  ASSERT_EQ(kept.size(), 1u);
  ASSERT_EQ(kept.at(kPlace).size(), 1u);
  const FakePilot pilot;
  EXPECT_EQ(kept.at(kPlace)[0].difference, PilotOf(pilot, *FoldPoint(pilot)).difference);
}

TEST_F(PilotsTest, AnotherRunComputesThePilotIfItsRunIsCancelled) {
  const auto first = Add(1, 1);
  ASSERT_EQ(BeginPilot(), 1);
  const auto second = Add(2, 2), third = Add(3, 3);
  for (int turn = 0; turn < 4; ++turn) local_.TakeTurn(1);  // the new runs open their points
  EXPECT_EQ(opener_.opened(), 1);
  scheduler_.Cancel(1);
  EXPECT_EQ(first->ends, 1);
  local_.TakeAllTurns();
  ExpectRight(*second, 2);
  ExpectRight(*third, 3);
  EXPECT_EQ(opener_.opened(), 2);
  EXPECT_EQ(opener_.kept().at(kPlace).size(), 1u);
}

TEST_F(PilotsTest, APilotThatFailsEndsItsRunOnly) {
  int blocks = 0;
  FakePilotOpener opener(OnePlace, [&](size_t, uint64_t, std::stop_token) {
    if (++blocks == 5) throw std::runtime_error("the pilot failed");
  });
  Scheduler scheduler(opener, 1);
  SteppedExecutor local(scheduler);
  const auto first = std::make_shared<RecordingJournal>();
  const auto second = std::make_shared<RecordingJournal>();
  scheduler.Add(RunOf(1, SpecOf(1), first));
  scheduler.Add(RunOf(2, SpecOf(2), second));
  local.TakeAllTurns();
  scheduler.Shutdown();
  const bool is_first = first->outcome && !first->outcome->ok();
  EXPECT_THAT(*(is_first ? first : second)->outcome,
              StatusIs(absl::StatusCode::kInternal, testing::HasSubstr("the pilot failed")));
  ExpectRight(is_first ? *second : *first, is_first ? 2 : 1);
  EXPECT_EQ(opener.opened(), 2);
}

TEST_F(PilotsTest, ThePilotsWorkIsChargedToTheRunThatComputesIt) {
  const auto first = Add(1, 1), second = Add(2, 2);
  double pilots_work = 0;
  int64_t owner = 0;
  while (const std::optional<Lease> lease = local_.Begin()) {
    const double seconds = lease->pilot ? 1 : 0;
    if (lease->pilot) owner = lease->run;
    pilots_work += seconds;
    local_.End(*lease, kBlocksOfATurn, seconds);
  }
  EXPECT_EQ(pilots_work, 4);  // 200 blocks, at most 64 a turn
  ASSERT_TRUE(owner == 1 || owner == 2);
  EXPECT_EQ((owner == 1 ? first : second)->work, pilots_work);
  EXPECT_EQ((owner == 1 ? second : first)->work, 0);
}

}  // namespace
}  // namespace ballpiston::server
