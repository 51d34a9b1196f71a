#include "client/figure/limit_floor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/client/figure/measurements.h"

namespace ballpiston::client {
namespace {

using ::testing::IsEmpty;

MethodMeasurement Spectrum(double delta, double value, double error) {
  return RelaxationTime(kSpectrum, delta, 0, 1e-6, value, error);
}

TEST(LimitFloor, ABiasIsResolvedFromTwoStandardErrorsOn) {
  const LimitFloor resolved = FloorsOf({Spectrum(0.2, 0.5, 0.25)}).front();
  EXPECT_TRUE(resolved.IsResolved());
  EXPECT_EQ(resolved.Height(), 0.5);
  const LimitFloor bound = FloorsOf({Spectrum(0.2, 0.4375, 0.25)}).front();
  EXPECT_FALSE(bound.IsResolved());
  EXPECT_EQ(bound.Height(), 0.4375 + 2 * 0.25);
}

TEST(LimitFloor, EachDeltaHasOneFromTheLargestDown) {
  const std::vector<LimitFloor> floors =
      FloorsOf({Spectrum(0.05, 0.01, 0), Spectrum(0.2, 0.05, 0), Spectrum(0.05, 0.01, 0)});
  ASSERT_EQ(floors.size(), 2u);
  EXPECT_EQ(floors[0].delta, 0.2);
  EXPECT_EQ(floors[1].delta, 0.05);
  EXPECT_EQ(floors[1].bias, 0.01);
  EXPECT_EQ(floors[1].work, 1e-6);
}

TEST(LimitFloor, OtherQuantitiesHaveNone) {
  MethodMeasurement other = Spectrum(0.2, 0.5, 0.25);
  other.quantity = kMeanFreeTime;
  EXPECT_THAT(FloorsOf({other}), IsEmpty());
  EXPECT_THAT(FloorsOf({RelaxationTime(kBilliard, 0.2, 1024, 1, 0.1, 0.1)}), IsEmpty());
}

// Nine times the work of the longest run, whose own error is three times the floor.
TEST(LimitFloor, TheBilliardsErrorFallsWithTheRootOfWork) {
  const std::vector<LimitFloor> floors =
      FloorsOf({RelaxationTime(kBilliard, 0.2, 256, 0.5, 0.1, 1),
                RelaxationTime(kBilliard, 0.2, 1024, 2, 0.1, 0.375),
                RelaxationTime(kBilliard, 0.1, 1024, 7, 0.1, 0.5),
                RelaxationTime(kMarkov, 0.2, 4096, 5, 0.1, 0.5), Spectrum(0.2, 0.125, 0)});
  ASSERT_TRUE(floors.front().crossing_work);
  EXPECT_EQ(*floors.front().crossing_work, 18);
}

TEST(LimitFloor, TooFewOrbitsTellNoCrossing) {
  const auto billiard = RelaxationTime(kBilliard, 0.2, kFewestOrbits - 1, 1, 0.1, 0.5);
  EXPECT_FALSE(FloorsOf({billiard, Spectrum(0.2, 0.5, 0.25)}).front().crossing_work);
}

// The error of a run combines its own statistical error and that of the reference value. The error
// of the spectrum is that of the reference value alone.
TEST(LimitFloor, TheErrorOfTheTruthIsSubtracted) {
  const LimitFloor floor = FloorsOf({Spectrum(0.2, 0.5, 3)}).front();
  EXPECT_EQ(OwnError(RelaxationTime(kMarkov, 0.2, 256, 1, 0.1, 5), floor), 4);
  EXPECT_EQ(OwnError(RelaxationTime(kMarkov, 0.2, 256, 1, 0.1, 2.9), floor), 0);
}

}  // namespace
}  // namespace ballpiston::client
