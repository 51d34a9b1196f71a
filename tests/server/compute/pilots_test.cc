// Pilots in the scheduler: which run computes a pilot, which runs wait for it, and which run is
// charged.
#include "server/compute/point_opener.h"
#include "tests/server/compute/stepped_scheduler.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

const PilotPlace kPlace = {{kRho, 0.53}, {kDelta, 0.1}};

// A pilot takes 200 blocks; a turn here computes 64.
constexpr uint64_t kBlocksOfATurn = 64;

EnsembleSpec PilotSpec() { return FakeSpec(1, 200, 99); }

// A fake experiment whose first estimate has a limit, as that of a pilot.
class FakePilot : public PointExperiment {
 public:
  explicit FakePilot(BeforeBlock before_block = nullptr)
      : FakePilot(FakeExperiments(std::move(before_block))(PilotSpec(), 0)) {}

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override {
    return fake_->StartRun(queue);
  }
  uint64_t CountsOfASample() const override { return fake_->CountsOfASample(); }

 private:
  explicit FakePilot(std::unique_ptr<const PointExperiment> fake)
      : PointExperiment(PilotSpec(), PointAt(PilotSpec(), 0), fake->plan()),
        fake_(std::move(fake)) {
    SetMeasurements(fake_->EmptyResult(),
                    {{.name = "mean",
                      .reading = [this](const BlockResult& m) { return fake_->FirstEstimate(m); },
                      .limit = 0.4}});
  }

  const std::unique_ptr<const PointExperiment> fake_;
};

// Every point needs the pilot at kPlace, except those of `free_seed`. The tests look at the
// members.
struct PilotOpener : PointOpener {
  OpenedPoint Open(const EnsembleSpec& spec, size_t index) override {
    if (kept.empty() && spec.seed != free_seed) return kPlace;
    return FakeExperiments()(spec, index);
  }
  std::unique_ptr<const PointExperiment> OpenPilot(const PilotPlace&) override {
    ++opened;
    return std::make_unique<const FakePilot>(before_block);
  }
  void KeepPilot(const PilotPlace& place, const Pilot& pilot) override {
    EXPECT_EQ(place, kPlace);
    kept.push_back(pilot);
  }

  uint64_t free_seed = 0;
  BeforeBlock before_block;  // of a pilot
  int opened = 0;            // pilots that began
  std::vector<Pilot> kept;
};

class PilotsTest : public SchedulerTest {
 protected:
  PilotsTest() : SchedulerTest(std::make_unique<PilotOpener>()) {}

  PilotOpener& opener() { return static_cast<PilotOpener&>(*opener_); }

  // Two points of 10 blocks. Runs of one principal take turns.
  static EnsembleSpec SpecOf(int64_t key) { return FakeSpec(2, 10, static_cast<uint64_t>(key)); }
  JournalPointer AddRun(int64_t key) { return Add(key, SpecOf(key)); }
};

TEST_F(PilotsTest, APilotIsComputedOnceForAllRuns) {
  const std::vector<JournalPointer> journals = {AddRun(1), AddRun(2), AddRun(3)};
  local_.TakeAllTurns(kBlocksOfATurn);
  for (int64_t key = 1; key <= 3; ++key) {
    ExpectComplete(SpecOf(key), *journals[static_cast<size_t>(key) - 1]);
  }
  EXPECT_EQ(opener().opened, 1);
  ASSERT_EQ(opener().kept.size(), 1u);
  const FakePilot pilot;
  EXPECT_EQ(opener().kept[0].difference, PilotOf(pilot, FoldPoint(pilot)).difference);
}

// Chunks of an earlier process, which knew the pilot.
TEST_F(PilotsTest, ChunksOfAPointThatWaitsForAPilotAreToBeReportedLater) {
  AddRun(1);
  Turns(1, 1);  // the point waits now
  EXPECT_THAT(scheduler_.Report({.run = 1, .local = false, .point = 0}, {}),
              StatusIs(absl::StatusCode::kUnavailable));
}

TEST_F(PilotsTest, AnotherRunComputesThePilotIfItsRunIsCancelled) {
  const auto first = AddRun(1);
  for (std::optional<Lease> lease = local_.Begin();; lease = local_.Begin()) {
    ASSERT_TRUE(lease);
    local_.End(*lease, 1);
    if (lease->pilot) break;
  }
  const auto second = AddRun(2), third = AddRun(3);
  Turns(4, 1);  // the new runs open their points
  EXPECT_EQ(opener().opened, 1);
  scheduler_.Cancel(1);
  EXPECT_EQ(first->ends, 1);
  local_.TakeAllTurns();
  ExpectComplete(SpecOf(2), *second);
  ExpectComplete(SpecOf(3), *third);
  EXPECT_EQ(opener().opened, 2);
  EXPECT_EQ(opener().kept.size(), 1u);
}

TEST_F(PilotsTest, APilotThatFailsEndsItsRunOnly) {
  int blocks = 0;
  opener().before_block = [&](size_t, uint64_t, std::stop_token) {
    if (++blocks == 5) throw std::runtime_error("the pilot failed");
  };
  const auto first = AddRun(1), second = AddRun(2);
  local_.TakeAllTurns();
  const bool is_first = !first->outcome->ok();
  EXPECT_THAT(*(is_first ? first : second)->outcome,
              StatusIs(absl::StatusCode::kInternal, HasSubstr("the pilot failed")));
  ExpectComplete(SpecOf(is_first ? 2 : 1), *(is_first ? second : first));
  EXPECT_EQ(opener().opened, 2);
}

// The run that owns the pilot comes last, after one that needs no pilot.
TEST_F(PilotsTest, ARunThatWaitsForAPilotComputesItInItsOwnTurns) {
  const auto low = AddRun(1);
  while (opener().opened == 0) ASSERT_TRUE(local_.TakeTurn(1));
  constexpr int64_t kFreeRun = 2, kHigh = 3;
  opener().free_seed = kFreeRun;
  const auto free_run = AddRun(kFreeRun), high = AddRun(kHigh);
  scheduler_.SetPriority(kFreeRun, 10);
  scheduler_.SetPriority(kHigh, 50);
  while (high->ends == 0) ASSERT_TRUE(local_.TakeTurn(kBlocksOfATurn));
  EXPECT_TRUE(free_run->finished.empty());
  EXPECT_EQ(opener().opened, 1);
  local_.TakeAllTurns();
  ExpectComplete(SpecOf(1), *low);
  ExpectComplete(SpecOf(kFreeRun), *free_run);
  ExpectComplete(SpecOf(kHigh), *high);
}

TEST_F(PilotsTest, ATurnAtAPilotIsChargedToTheRunWhoseTurnItIs) {
  AddRun(1);
  AddRun(2);
  std::multiset<int64_t> payers;
  while (const std::optional<Lease> lease = local_.Begin()) {
    if (lease->pilot) payers.insert(lease->payer);
    local_.End(*lease, 20, lease->pilot ? 1 : 0);
  }
  EXPECT_EQ(payers.count(1), 5u);
  EXPECT_EQ(payers.count(2), 5u);
}

TEST_F(PilotsTest, ThePilotsWorkIsCountedByTheJobThatOwnsIt) {
  const auto first = AddRun(1), second = AddRun(2);
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
