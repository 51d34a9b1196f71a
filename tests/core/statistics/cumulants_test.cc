#include "core/statistics/cumulants.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// A Poisson law of mean 2: all its cumulants are 2.
TEST(Cumulants, CumulantsOfKnownLaws) {
  constexpr int kNumbers = 1'000'000;
  Moments poisson, even;
  double probability = std::exp(-2.0);
  for (int n = 0; n < 30; ++n) {
    const auto times = static_cast<int>(std::lround(kNumbers * probability));
    for (int i = 0; i < times; ++i) poisson.Add(n);
    probability *= 2.0 / (n + 1);
  }
  for (const int order : {2, 3, 4}) EXPECT_NEAR(Cumulant(poisson, order), 2, 0.01) << order;
  for (int i = 0; i < 10; ++i) even.Add(i % 2 == 0 ? -1 : 1);
  EXPECT_NEAR(Cumulant(even, 2), 1, 1e-14);
  EXPECT_NEAR(Cumulant(even, 3), 0, 1e-14);
  EXPECT_NEAR(Cumulant(even, 4), -2, 1e-14);
}

TEST(Cumulants, TheJackknifeOfAMeanIsItsStandardError) {
  const std::vector<double> numbers = {3, 1, 4, 1, 5, 9, 2, 6};
  Moments all;
  for (const double x : numbers) all.Add(x);
  const Jackknifed found = Jackknife(numbers.size(), [&](size_t without) {
    Moments left;
    for (size_t i = 0; i < numbers.size(); ++i) {
      if (i != without) left.Add(numbers[i]);
    }
    return left.mean;
  });
  EXPECT_NEAR(found.value, all.mean, 1e-14);
  EXPECT_NEAR(found.error, *all.StandardError(), 1e-14);
}

}  // namespace
}  // namespace ballpiston
