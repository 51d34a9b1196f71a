#include "server/scheduling/model_ladder.h"

#include <atomic>
#include <latch>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/engine_version.h"
#include "core/experiment/all_experiments.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/store/pilot_table.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/store_access.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;

// Small enough a delta, and large enough a tolerance, that a pilot decides.
EnsembleSpec Relaxation(std::vector<double> deltas = {0.005}) {
  return {.experiment = &kEnergyRelaxation,
          .grid = {{kRho, {0.5296}}, {kDelta, std::move(deltas)}},
          .target = {.tolerance = 0.02}};
}

PilotPlace PlaceOf(const EnsembleSpec& spec) { return PilotPlaceFor(PointAt(spec, 0)); }

// Pilots that cost nothing, are counted, and can be held up.
class ModelLadderTest : public testing::Test {
 protected:
  ModelLadderTest() : store_(*Store::Open(folder_.File("store.sqlite3"), {})) {}
  ~ModelLadderTest() override { gate_.Open(); }

  PilotRunner Runner() {
    return [this](const PilotPlace& place, std::stop_token stop) -> std::optional<Pilot> {
      ++runs_;
      if (held_ && place == *held_) gate_.Pass(stop);
      if (stop.stop_requested()) return std::nullopt;
      return found_;
    };
  }

  std::unique_ptr<const PointExperiment> Create(ModelLadder& ladder, const EnsembleSpec& spec,
                                                const std::stop_token& stop = {}) {
    return ladder.ChosenExperiments()(spec, 0, stop);
  }

  std::optional<Pilot> Stored(const PilotPlace& place) {
    EXPECT_OK(store_->Flush());
    return ReadFrom(*store_, [&](Database& database) {
      return FindPilot(database, std::string(kEngineVersion), place);
    });
  }

  TemporaryFolder folder_;
  std::unique_ptr<Store> store_;
  Gate gate_;
  std::optional<PilotPlace> held_;  // this place's pilot waits at the gate
  std::atomic<int> runs_ = 0;
  Pilot found_ = {.difference = 0.01, .standard_error = 0.001};
};

TEST_F(ModelLadderTest, APilotIsRunOnceAndStored) {
  const EnsembleSpec spec = Relaxation();
  ModelLadder ladder(*store_, 2, Runner());
  for (int asked = 0; asked < 3; ++asked) {
    const auto experiment = Create(ladder, spec);
    EXPECT_EQ(experiment->answer().model, Model::kSpectrum);
    EXPECT_EQ(experiment->answer().model_error,
              LimitErrorBound(found_, PlaceOf(spec), PointAt(spec, 0)));
    EXPECT_THAT(experiment->answer().reason, HasSubstr("two sigma of a pilot at delta = "));
  }
  EXPECT_EQ(runs_, 1);
  const auto stored = Stored(PlaceOf(spec));
  ASSERT_TRUE(stored);
  EXPECT_EQ(stored->difference, found_.difference);
  EXPECT_EQ(stored->standard_error, found_.standard_error);
}

TEST_F(ModelLadderTest, AnotherServerOnTheSameStoreDoesNotRunItAgain) {
  const EnsembleSpec spec = Relaxation();
  Answer first;
  {
    ModelLadder ladder(*store_, 2, Runner());
    first = Create(ladder, spec)->answer();
  }
  ASSERT_OK(store_->Flush());
  ModelLadder ladder(*store_, 7, Runner());
  const Answer second = Create(ladder, spec)->answer();
  EXPECT_EQ(runs_, 1);
  EXPECT_EQ(second.model, first.model);
  EXPECT_EQ(second.reason, first.reason);
  EXPECT_EQ(second.model_error, first.model_error);
}

TEST_F(ModelLadderTest, TheBilliardIsChosenIfThePilotFindsALargeLimitError) {
  found_.difference = 1;
  ModelLadder ladder(*store_, 2, Runner());
  const auto experiment = Create(ladder, Relaxation());
  EXPECT_EQ(experiment->answer().model, Model::kBilliard);
  EXPECT_THAT(experiment->answer().reason, HasSubstr("beyond the tolerance"));
  EXPECT_EQ(runs_, 1);
}

TEST_F(ModelLadderTest, OneStoredPilotServesAllSmallerDeltas) {
  ModelLadder ladder(*store_, 2, Runner());
  for (const double delta : {0.005, 0.004, 0.003}) Create(ladder, Relaxation({delta}));
  EXPECT_EQ(runs_, 1);
}

TEST_F(ModelLadderTest, JobsWaitForARunningPilotOfTheirPlace) {
  constexpr int kThreads = 8;
  const EnsembleSpec spec = Relaxation();
  held_ = PlaceOf(spec);
  ModelLadder ladder(*store_, 2, Runner());
  std::latch all_ask(kThreads);
  std::atomic<int> by_spectrum = 0;
  std::vector<std::jthread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&] {
      all_ask.count_down();
      by_spectrum += Create(ladder, spec)->answer().model == Model::kSpectrum;
    });
  }
  all_ask.wait();
  gate_.AwaitWaiting(1);
  // Another place's pilot does not wait for this one.
  EnsembleSpec elsewhere = spec;
  elsewhere.grid[kRho] = {0.55};
  EXPECT_NE(Create(ladder, elsewhere), nullptr);
  gate_.Open();
  threads.clear();  // joins
  EXPECT_EQ(by_spectrum, kThreads);
  EXPECT_EQ(runs_, 2);
}

TEST_F(ModelLadderTest, WaitingAndRunningPilotsCanBeStopped) {
  const EnsembleSpec spec = Relaxation();
  held_ = PlaceOf(spec);
  ModelLadder ladder(*store_, 2, Runner());
  std::stop_source stop_runner, stop_waiter;
  std::jthread runner([&] { EXPECT_EQ(Create(ladder, spec, stop_runner.get_token()), nullptr); });
  gate_.AwaitWaiting(1);
  std::jthread waiter([&] { EXPECT_EQ(Create(ladder, spec, stop_waiter.get_token()), nullptr); });
  stop_waiter.request_stop();
  waiter.join();
  EXPECT_EQ(runs_, 1);
  // One that is stopped leaves nothing behind, and whoever comes next runs it.
  stop_runner.request_stop();
  runner.join();
  EXPECT_FALSE(Stored(PlaceOf(spec)));
  gate_.Open();
  EXPECT_NE(Create(ladder, spec), nullptr);
  EXPECT_EQ(runs_, 2);
  EXPECT_TRUE(Stored(PlaceOf(spec)));
}

TEST_F(ModelLadderTest, WithoutNeedNoPilotIsRun) {
  ModelLadder ladder(*store_, 2, Runner());
  EnsembleSpec closed = Relaxation();
  closed.experiment = &kEquilibrium;
  EXPECT_EQ(Create(ladder, closed)->answer().model, Model::kClosedForm);
  EnsembleSpec exact = Relaxation();
  exact.target = {.samples = 100};
  EXPECT_EQ(Create(ladder, exact)->answer().model, Model::kBilliard);
  EnsembleSpec strict = Relaxation();
  strict.target.tolerance = 1e-7;
  EXPECT_EQ(Create(ladder, strict)->answer().model, Model::kBilliard);
  EnsembleSpec told = Relaxation();
  told.model = Model::kMarkov;
  EXPECT_EQ(Create(ladder, told)->answer().model, Model::kMarkov);
  EXPECT_EQ(runs_, 0);
}

TEST_F(ModelLadderTest, APlanRunsNoPilotAndSaysWhetherThereIsOne) {
  const EnsembleSpec spec = Relaxation();
  ModelLadder ladder(*store_, 2, Runner());
  const Ladder before = ladder.LadderOf(spec, PointAt(spec, 0));
  EXPECT_EQ(before.answer.model, Model::kSpectrum);
  EXPECT_THAT(before.answer.reason, HasSubstr("expected of a pilot"));
  EXPECT_EQ(runs_, 0);
  EXPECT_FALSE(Stored(PlaceOf(spec)));
  Create(ladder, spec);
  const Ladder after = ladder.LadderOf(spec, PointAt(spec, 0));
  EXPECT_THAT(after.answer.reason, HasSubstr("two sigma of a pilot at delta = "));
  EXPECT_EQ(runs_, 1);
  // What a pilot has established, it need not cost again.
  EXPECT_LT(*after.Chosen().work, *before.Chosen().work);
}

}  // namespace
}  // namespace ballpiston::server
