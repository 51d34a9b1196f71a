#include "core/model_choice/limit_error.h"

#include "core/ensemble/point_fold.h"
#include "tests/core/model_choice/questions.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

TEST(LimitError, PilotsAreAtDeltasWithCheapCollisions) {
  const double cheap = PilotPlaceFor(PaperPoint(1e-6))[kDelta];
  EXPECT_GT(cheap, 0.2 * PairDeltaBound(kPaperRho));
  EXPECT_LT(cheap, 0.4 * PairDeltaBound(kPaperRho));
  EXPECT_EQ(PilotPlaceFor(PaperPoint(1e-3)), PilotPlaceFor(PaperPoint(1e-6)));
  EXPECT_EQ(PilotPlaceFor(PaperPoint(0.3))[kDelta], 0.3);
  EXPECT_EQ(PilotPlaceFor(PaperPoint(0.3)).Find(kEpsilon), std::nullopt);
}

// From an energy at which a body is slow, the limit may not apply at the pilot's delta, and the
// error may not fall in proportion to delta. Then the pilot is at the point itself.
TEST(LimitError, PilotsFromAnEnergyAreAtDeltasWithSmallErrors) {
  EXPECT_EQ(PilotPlaceFor(PaperPoint(1e-3, 0.1))[kDelta], PilotPlaceFor(PaperPoint(1e-3))[kDelta]);
  EXPECT_EQ(PilotPlaceFor(PaperPoint(1e-3, 0.1)).Find(kEpsilon), 0.1);
  for (const double epsilon : {0.0, 1e-6, 0.4999999, 0.5}) {
    EXPECT_EQ(PilotPlaceFor(PaperPoint(1e-3, epsilon)), PaperPoint(1e-3, epsilon));
  }
}

TEST(LimitError, BoundIsTheDifferenceAndTwoErrorsScaledWithDelta) {
  const Pilot pilot = {.difference = -0.03, .standard_error = 0.005};
  const PilotPlace place = PaperPoint(0.1);
  EXPECT_DOUBLE_EQ(LimitErrorBound(pilot, place, PaperPoint(0.1)), 0.04);
  EXPECT_DOUBLE_EQ(LimitErrorBound(pilot, place, PaperPoint(0.001)), 0.0004);
  // The bound is at least the expected error, also if a pilot finds no difference by chance.
  const Pilot lucky = {.difference = 0, .standard_error = 1e-9};
  EXPECT_EQ(LimitErrorBound(lucky, place, PaperPoint(0.05)), ExpectedLimitError(PaperPoint(0.05)));
}

// The expected result of a pilot, scaled from its place, covers the expected error at smaller
// deltas: the bound's proportion to delta is on the safe side.
TEST(LimitError, BoundCoversTheExpectedErrorAtSmallerDeltas) {
  const PilotPlace place = PilotPlaceFor(PaperPoint(1e-6));
  const Pilot pilot = {.difference = ExpectedLimitError(PaperPoint(place[kDelta])),
                       .standard_error = 0};
  for (double delta = place[kDelta]; delta > 1e-6; delta /= 2) {
    EXPECT_GE(LimitErrorBound(pilot, place, PaperPoint(delta)) * (1 + 1e-12),
              ExpectedLimitError(PaperPoint(delta)));
  }
}

// At the largest delta, where a pilot costs least; from an energy, because such orbits are shorter.
TEST(LimitError, PilotIsAFunctionOfItsPlace) {
  const PilotPlace place = PaperPoint(PairDeltaBound(kPaperRho), 0.01);
  const auto run = [&] {
    const auto experiment = PilotExperiment(place);
    return PilotOf(*experiment, FoldPoint(*experiment));
  };
  const Pilot first = run(), second = run();
  EXPECT_EQ(first.difference, second.difference);
  EXPECT_EQ(first.standard_error, second.standard_error);
  EXPECT_FALSE(first.predicted);
  EXPECT_TRUE(PredictedPilot(place).predicted);
  EXPECT_LT(first.standard_error, 2 * PredictedPilot(place).standard_error);
  EXPECT_GT(first.standard_error, PredictedPilot(place).standard_error / 2);
  // Far from the limit there.
  EXPECT_GT(std::fabs(first.difference), 10 * first.standard_error);
}

}  // namespace
}  // namespace ballpiston
