#include "tools/method_comparison/limit_floor.h"

#include "tests/core/preamble.h"

namespace ballpiston::method_comparison {
namespace {

MethodMeasurement Spectrum(double value, double error) {
  return {.method = Method::kSpectrum,
          .quantity = Quantity::kRelaxationTime,
          .delta = 0.2,
          .work = 1e-6,
          .value = value,
          .statistical_error = error};
}

MethodMeasurement Billiard(uint64_t samples, double work, double own_error) {
  return {.method = Method::kLanes,
          .quantity = Quantity::kRelaxationTime,
          .delta = 0.2,
          .samples = samples,
          .work = work,
          .own_error = own_error};
}

TEST(LimitFloor, ABiasIsResolvedFromTwoStandardErrorsOn) {
  const MethodMeasurement resolved = LimitFloorOf(Spectrum(0.5, 0.25), {});
  EXPECT_EQ(resolved.quantity, Quantity::kLimitFloor);
  EXPECT_EQ(resolved.delta, 0.2);
  EXPECT_EQ(resolved.bias_resolved, true);
  EXPECT_EQ(resolved.value, 0.5);
  EXPECT_EQ(resolved.statistical_error, 0.25);
  const MethodMeasurement bound = LimitFloorOf(Spectrum(0.4375, 0.25), {});
  EXPECT_EQ(bound.bias_resolved, false);
  EXPECT_EQ(bound.value, 0.4375 + 2 * 0.25);
}

// The billiard's own error is three times the floor: it needs nine times the work.
TEST(LimitFloor, TheBilliardsErrorFallsWithTheRootOfWork) {
  EXPECT_EQ(LimitFloorOf(Spectrum(0.125, 0), Billiard(1024, 2, 0.375)).work, 18);
}

TEST(LimitFloor, TooFewOrbitsDetermineNoCrossing) {
  const MethodMeasurement billiard = Billiard(kFewestFloorOrbits - 1, 1, 0.5);
  EXPECT_EQ(LimitFloorOf(Spectrum(0.5, 0.25), billiard).work, std::nullopt);
}

}  // namespace
}  // namespace ballpiston::method_comparison
