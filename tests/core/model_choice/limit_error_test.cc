#include "core/model_choice/limit_error.h"

#include "core/ensemble/point_fold.h"
#include "core/experiment/energy_relaxation.h"
#include "tests/core/model_choice/questions.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// Relative errors and their standard errors, measured with 20,000 orbits or more. At rho = 0.501
// the tips are narrow and collisions repeat; the piston meets a slow ball again after its stroke.
TEST(LimitError, BoundIsAboveTheMeasuredErrorAndOfItsOrder) {
  struct Place {
    double rho, delta;
    std::optional<double> epsilon;
    double measured, standard_error;
  };
  for (const Place& place : {Place{kPaperRho, 0.2, {}, 0.049, 0.001},
                             {kPaperRho, 0.1, {}, 0.0175, 0.0005},
                             {0.501, 0.1, {}, 0.14, 0.01},
                             {0.52, 0.03, 0.4999, 5.853, 0.05},
                             {0.5001, 0.026, 0.4965, 3.185, 0.041},
                             {0.5007, 0.06, 0.4991, 6.658, 0.052},
                             {0.525, 0.022, 0.499997, 14.07, 0.052},
                             {0.5128, 0.085, 0.49956, 6.162, 0.051}}) {
    const double stated =
        ExpectedLimitError({{kRho, place.rho}, {kDelta, place.delta}, {kEpsilon, place.epsilon}});
    EXPECT_GT(stated, place.measured - (place.epsilon ? 2 * place.standard_error : 0)) << place.rho;
    EXPECT_LT(stated, (place.epsilon ? 2.5 : 3) * place.measured) << place.rho;
  }
}

// x log(1/x) with x of order delta^2: between delta^2 and delta.
TEST(LimitError, FallsNearlyAsTheSquareOfDelta) {
  for (double delta = 0.02; delta > 1e-7; delta /= 10) {
    const double ratio =
        ExpectedLimitError(PaperPoint(delta)) / ExpectedLimitError(PaperPoint(delta / 10));
    EXPECT_GT(ratio, 50) << delta;
    EXPECT_LT(ratio, 100) << delta;
  }
}

TEST(LimitError, GrowsTowardsSlowPartners) {
  double before = 100;
  for (const double epsilon : {0.0, 1e-20, 1e-8, 1e-4, 0.01}) {
    EXPECT_LE(ExpectedLimitError(PaperPoint(0.05, epsilon)), before * 1.001);
    before = ExpectedLimitError(PaperPoint(0.05, epsilon));
  }
  EXPECT_GT(ExpectedLimitError(PaperPoint(0.05, 0.5)), ExpectedLimitError(PaperPoint(0.05, 0.49)));
  EXPECT_GT(ExpectedLimitError(PaperPoint(0.05, 0.49)), ExpectedLimitError(PaperPoint(0.05, 0.4)));
  for (const double epsilon : {0.0, 0.5}) {
    EXPECT_GE(ExpectedLimitError(PaperPoint(0.05, epsilon)), 1);  // the limit does not apply
    // No more than an energy that never changes makes.
    const double stuck = kWindowTimes * std::fabs(epsilon - kMeanPistonEnergy);
    EXPECT_LE(ExpectedLimitError(PaperPoint(1e-6, epsilon)), stuck / 0.1);
  }
}

// The relaxation time is a ratio, and the limit's decay integral passes through 0 at 0.141: -0.0165
// mean free times at 0.12, 0.12 at 0.4.
TEST(LimitError, GrowsTowardsTheZoneWithoutARelaxationTime) {
  const auto error = [](double epsilon) { return ExpectedLimitError(PaperPoint(0.05, epsilon)); };
  EXPECT_GT(error(0.12), 2 * error(0.08));
  EXPECT_GT(error(0.08), error(0.04));
  EXPECT_GT(error(0.2), 2 * error(0.3));
}

TEST(LimitError, PilotsAreAtDeltasWithCheapCollisions) {
  const double cheap = PilotPlaceFor(PaperPoint(1e-6)).delta;
  EXPECT_GT(cheap, 0.2 * PairDeltaBound(kPaperRho));
  EXPECT_LT(cheap, 0.4 * PairDeltaBound(kPaperRho));
  EXPECT_EQ(PilotPlaceFor(PaperPoint(1e-3)), PilotPlaceFor(PaperPoint(1e-6)));
  EXPECT_EQ(PilotPlaceFor(PaperPoint(0.3)).delta, 0.3);
  EXPECT_EQ(PilotPlaceFor(PaperPoint(0.3)).epsilon, std::nullopt);
}

// From an energy at which a body is slow, the limit may not apply at the pilot's delta, and the
// error may not fall in proportion to delta. Then the pilot is at the point itself.
TEST(LimitError, PilotsFromAnEnergyAreAtDeltasWithSmallErrors) {
  EXPECT_EQ(PilotPlaceFor(PaperPoint(1e-3, 0.1)).delta, PilotPlaceFor(PaperPoint(1e-3)).delta);
  EXPECT_EQ(PilotPlaceFor(PaperPoint(1e-3, 0.1)).epsilon, 0.1);
  for (const double epsilon : {0.0, 1e-6, 0.4999999, 0.5}) {
    EXPECT_EQ(PilotPlaceFor(PaperPoint(1e-3, epsilon)), (PilotPlace{kPaperRho, 1e-3, epsilon}));
  }
}

TEST(LimitError, BoundIsTheDifferenceAndTwoErrorsScaledWithDelta) {
  const Pilot pilot = {.difference = -0.03, .standard_error = 0.005};
  const PilotPlace place = {.rho = kPaperRho, .delta = 0.1};
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
  const Pilot pilot = {.difference = ExpectedLimitError(PaperPoint(place.delta)),
                       .standard_error = 0};
  for (double delta = place.delta; delta > 1e-6; delta /= 2) {
    EXPECT_GE(LimitErrorBound(pilot, place, PaperPoint(delta)) * (1 + 1e-12),
              ExpectedLimitError(PaperPoint(delta)));
  }
}

// At the largest delta, where a pilot costs least; from an energy, because such orbits are shorter.
TEST(LimitError, PilotIsAFunctionOfItsPlace) {
  const PilotPlace place = {.rho = kPaperRho, .delta = PairDeltaBound(kPaperRho), .epsilon = 0.01};
  const auto run = [&] {
    const auto experiment = PilotExperiment(place);
    return PilotOf(*experiment, *FoldPoint(*experiment));
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
