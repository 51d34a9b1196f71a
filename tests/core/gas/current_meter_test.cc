#include "core/gas/current_meter.h"

#include "core/gas/gas_meter.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

double Sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(CurrentSteps, StepsHoldTheWholeCurrent) {
  constexpr double kDuration = 7;
  CurrentSteps constant(kDuration, kCurrentSteps), points(kDuration, kCurrentSteps);
  std::mt19937_64 random(3);
  std::exponential_distribution<double> wait(5);
  double since = 0;
  for (double time = wait(random); time < kDuration; time += wait(random)) {
    constant.AddOver(since, time, 2);
    points.AddAt(time, 1);
    since = time;
  }
  constant.AddOver(since, kDuration, 2);
  for (const double value : constant.values()) EXPECT_NEAR(value, 2 * constant.length(), 1e-13);
  EXPECT_NEAR(Sum(constant.values()), 2 * kDuration, 1e-12);
  EXPECT_GT(Sum(points.values()), 20);
  points.AddAt(kDuration, 1);  // is in the last step
  EXPECT_GE(points.values().back(), 1);
}

// Two exchanges, three steps apart, and nothing else: their product counts from a window of three
// steps on, and the product of an exchange with itself does not count.
TEST(CarriedCurrent, CountsProductsOfDifferentExchanges) {
  constexpr double kStep = 0.5, kRate = 0.25;
  constexpr size_t kCells = 2;
  CarriedCurrent current(kCells, kRate, kStep * kCurrentSteps);
  current.Exchange({.time = 10.1 * kStep}, 6);
  current.Exchange({.time = 13.7 * kStep}, -4);
  const GreenKubo result = current.Result();
  const double product = 3 * -2 / static_cast<double>(kCurrentSteps - 3);
  for (size_t lag = 0; lag <= kWindow; ++lag) {
    EXPECT_NEAR(result.autocorrelation[lag], lag == 3 ? product / (kCells * kStep * kStep) : 0,
                1e-14);
    EXPECT_NEAR(result.conductivity[lag], kRate / 2 + (lag < 3 ? 0 : product / (kCells * kStep)),
                1e-14);
  }
  EXPECT_EQ(result.plain, result.conductivity[kWindow]);
}

}  // namespace
}  // namespace ballpiston
