#include "server/compute/model_ladder.h"

#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

// Small enough a delta, and large enough a tolerance, that a pilot decides.
EnsembleSpec Relaxation(std::vector<double> deltas = {0.005}) {
  return {.experiment = &kEnergyRelaxation,
          .grid = {{kRho, {0.5296}}, {kDelta, std::move(deltas)}},
          .target = {.tolerance = 0.02}};
}

PilotPlace PlaceOf(const EnsembleSpec& spec) { return PilotPlaceFor(PointAt(spec, 0)); }

class ModelLadderTest : public testing::Test {
 protected:
  ModelLadderTest()
      : store_(*Store::Open(folder_.File("store.sqlite3"), {.stall = kUnreachedLimit})) {}

  // The experiment; runs a pilot, which costs nothing, if the ladder asks for one.
  std::unique_ptr<const PointExperiment> Create(ModelLadder& ladder, const EnsembleSpec& spec) {
    OpenedPoint opened = ladder.Open(spec, 0);
    if (const auto* place = std::get_if<PilotPlace>(&opened)) {
      ++runs_;
      ladder.KeepPilot(*place, found_);
      opened = ladder.Open(spec, 0);
    }
    return std::get<std::unique_ptr<const PointExperiment>>(std::move(opened));
  }

  std::optional<Pilot> Stored(const PilotPlace& place) {
    EXPECT_OK(store_->Flush());
    return ReadFrom(*store_, [&](Database& database) {
      return FindPilot(database, std::string(kEngineVersion), place);
    });
  }

  TemporaryFolder folder_;
  std::unique_ptr<Store> store_;
  int runs_ = 0;
  Pilot found_ = {.difference = 0.01, .standard_error = 0.001};
};

TEST_F(ModelLadderTest, APilotIsRequestedOnceAndStored) {
  const EnsembleSpec spec = Relaxation();
  ModelLadder ladder(*store_, 2);
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

TEST_F(ModelLadderTest, AnotherServerUsesTheStoredPilot) {
  const EnsembleSpec spec = Relaxation();
  Answer first;
  {
    ModelLadder ladder(*store_, 2);
    first = Create(ladder, spec)->answer();
  }
  ASSERT_OK(store_->Flush());
  ModelLadder ladder(*store_, 7);
  const Answer second = Create(ladder, spec)->answer();
  EXPECT_EQ(runs_, 1);
  EXPECT_EQ(second.model, first.model);
  EXPECT_EQ(second.reason, first.reason);
  EXPECT_EQ(second.model_error, first.model_error);
}

TEST_F(ModelLadderTest, APlanRunsNoPilotAndSaysWhetherThereIsOne) {
  const EnsembleSpec spec = Relaxation();
  ModelLadder ladder(*store_, 2);
  const Ladder before = ladder.LadderOf(spec, PointAt(spec, 0));
  EXPECT_EQ(before.answer.model, Model::kSpectrum);
  EXPECT_THAT(before.answer.reason, HasSubstr("expected of a pilot"));
  EXPECT_EQ(before.pilot, PlaceOf(spec));
  // The second point of a plan that uses this pilot does not run it again.
  const Ladder second = ladder.LadderOf(spec, PointAt(spec, 0), {PlaceOf(spec)});
  EXPECT_FALSE(second.pilot);
  EXPECT_EQ(second.answer.reason, before.answer.reason);
  EXPECT_EQ(runs_, 0);
  EXPECT_FALSE(Stored(PlaceOf(spec)));
  Create(ladder, spec);
  const Ladder after = ladder.LadderOf(spec, PointAt(spec, 0));
  EXPECT_THAT(after.answer.reason, HasSubstr("two sigma of a pilot at delta = "));
  EXPECT_EQ(runs_, 1);
  // After the pilot, the plan's work does not include a pilot.
  EXPECT_LT(*after.Chosen().work, *before.Chosen().work);
}

}  // namespace
}  // namespace ballpiston::server
