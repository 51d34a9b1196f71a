#include "core/statistics/kl_divergence.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/sampling/counter_random.h"
#include "core/statistics/moments.h"

namespace ballpiston {
namespace {

TEST(KlDivergence, OfEqualLawsIsZero) {
  const KlDivergence kl =
      RelativeEntropy(std::array<uint64_t, 2>{300, 100}, std::array{0.75, 0.25});
  EXPECT_NEAR(kl.value, 0, 1e-16);
  EXPECT_EQ(kl.cells, 2);
  EXPECT_DOUBLE_EQ(kl.noise_floor, 1.0 / 800);
}

TEST(KlDivergence, IsTheSumOfPLogPOverQ) {
  const KlDivergence kl =
      RelativeEntropy(std::array<uint64_t, 3>{2, 0, 2}, std::array{0.25, 0.5, 0.25});
  EXPECT_DOUBLE_EQ(kl.value, std::log(2));
}

TEST(KlDivergence, OfAnImpossibleCountIsInfinite) {
  const KlDivergence kl = RelativeEntropy(std::array<uint64_t, 2>{1, 1}, std::array{1.0, 0.0});
  EXPECT_TRUE(std::isinf(kl.value));
  EXPECT_EQ(kl.cells, 1);
}

KlDivergence OfSample(CounterRandom& random, size_t cells, int samples, double tilt) {
  std::vector<uint64_t> counts(cells);
  for (int i = 0; i < samples; ++i) {
    const double u = random.Uniform();
    // Density 1 + tilt (2 x - 1) on [0, 1], by inversion of x + tilt (x^2 - x).
    const double b = 1 - tilt;
    const double x = tilt == 0 ? u : (std::sqrt(b * b + 4 * tilt * u) - b) / (2 * tilt);
    ++counts[static_cast<size_t>(x * static_cast<double>(cells))];
  }
  return RelativeEntropy(counts, std::vector<double>(cells, 1 / static_cast<double>(cells)));
}

// 400 repetitions: the mean has a standard error of 1/20 of the spread of one, the spread itself is
// known to sqrt(1/800) = 3.5 percent. Windows of 5 of these: false alarms 1e-6.
TEST(KlDivergence, NoiseFloorAndErrorHoldForEqualLaws) {
  CounterRandom random(2, 0, 0);
  Moments values;
  KlDivergence last;
  for (int i = 0; i < 400; ++i) values.Add((last = OfSample(random, 100, 10'000, 0)).value);
  const double spread = std::sqrt(*values.Variance());
  EXPECT_NEAR(values.mean, last.noise_floor, 5 * spread / 20);
  const double expected = std::sqrt(2 * 99.0) / (2 * 10'000);
  EXPECT_NEAR(spread, expected, 5 * 0.035 * expected);
}

TEST(KlDivergence, ErrorHoldsForUnequalLaws) {
  CounterRandom random(4, 0, 0);
  Moments values, errors;
  for (int i = 0; i < 400; ++i) {
    const KlDivergence kl = OfSample(random, 100, 10'000, 0.3);
    values.Add(kl.value);
    errors.Add(kl.StandardError());
  }
  EXPECT_NEAR(std::sqrt(*values.Variance()), errors.mean, 5 * 0.05 * errors.mean);
}

}  // namespace
}  // namespace ballpiston
