#include "core/statistics/group_scatter.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

constexpr size_t kRows = 3, kCells = 30;

// Each orbit repeats each of its samples. One row is three times as frequent as the others.
std::vector<Histogram> Groups(uint64_t seed, int orbits, int samples, uint64_t repeats) {
  std::vector<Histogram> groups(kGroups, Histogram::OfBins(0, 1, kCells));
  CounterRandom random(seed, 1, 0);
  for (int orbit = 0; orbit < orbits; ++orbit) {
    for (int i = 0; i < samples; ++i) {
      const double row = std::fmax(std::floor(5 * random.Uniform()) - 2, 0);
      const auto cell = static_cast<size_t>(kCells / kRows * (row + random.Uniform()));
      groups[static_cast<size_t>(orbit) % kGroups].counts[cell] += repeats;
    }
  }
  return groups;
}

// The means over 300 samples, with the windows of 5 standard errors: false alarms 6e-7 each.
void ExpectScatter(int samples, uint64_t repeats, double chi_squared, double variance) {
  Moments first, second;
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    const GroupScatter scatter = ScatterOfGroups(Groups(seed, 100, samples, repeats), kRows);
    first.Add(scatter.chi_squared);
    second.Add(scatter.of_pairs + scatter.of_orbits);
  }
  EXPECT_NEAR(first.mean, chi_squared, 5 * *first.StandardError());
  EXPECT_NEAR(second.mean, variance, 5 * *second.StandardError());
}

// With 107 and with 3 samples a cell.
TEST(GroupScatter, IndependentSamplesScatterAsExpected) {
  ExpectScatter(32, 1, 1, 1);
  ExpectScatter(1, 1, 1, 1);
}

// The counts' variances are three times as large, and so is a chi-squared.
TEST(GroupScatter, RepeatedSamplesCountOnce) { ExpectScatter(10, 3, 3, 9); }

// On average one orbit in 150 stays in one cell. 300 repetitions measure the variance of the
// chi-squared to about 10 %, and the window is 2.5 times that: a false alarm in one seed of 80. The
// pairs alone account for less than half of the variance.
TEST(GroupScatter, OrbitsThatStayInACellAddTheirOwnScatter) {
  constexpr int kOrbits = 300, kSamples = 300;
  Moments chi_squared, stated, of_pairs;
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    std::vector<Histogram> groups(kGroups, Histogram::OfBins(0, 1, kCells));
    CounterRandom random(seed, 2, 0);
    for (size_t orbit = 0; orbit < kOrbits; ++orbit) {
      const bool stays = random.Uniform() < 1 / 150.0;
      double x = random.Uniform();
      for (int i = 0; i < kSamples; ++i) {
        groups[orbit % kGroups].Add(x);
        if (!stays) x = random.Uniform();
      }
    }
    const double expected = double{kOrbits} * kSamples / kCells;
    double sum = 0;
    for (const uint64_t count : CountsOf(groups)) {
      sum += std::pow(static_cast<double>(count) - expected, 2) / expected;
    }
    chi_squared.Add(sum);
    const GroupScatter scatter = ScatterOfGroups(groups, 1);
    stated.Add(scatter.of_pairs + scatter.of_orbits);
    of_pairs.Add(scatter.of_pairs);
  }
  const double measured = *chi_squared.Variance() / (2 * (kCells - 1));
  EXPECT_LT(of_pairs.mean, measured / 2);
  EXPECT_NEAR(stated.mean / measured, 1, 0.25);
}

TEST(GroupScatter, VarianceOfASumIsThatOfItsGroups) {
  std::vector<Histogram> groups(kGroups, Histogram::OfBins(0, 1, 2));
  for (size_t g = 0; g < kGroups; ++g) groups[g].counts = {g % 2 == 0 ? 3u : 1u, 0};
  const std::vector<double> weights = {1, 1};
  std::vector<Histogram> balanced = groups;
  for (size_t g = 0; g < kGroups; ++g) balanced[g].counts[1] = g % 2 == 0 ? 1 : 3;
  // Deviations of +2 and -2 in each group.
  const std::vector<double> difference = {1, -1};
  EXPECT_DOUBLE_EQ(VarianceBetweenGroups(balanced, difference), 16 * 16 / 15.0 * 4);
  EXPECT_FALSE(HaveSamples(std::vector<Histogram>(kGroups, Histogram::OfBins(0, 1, 2))));
  EXPECT_TRUE(HaveSamples(groups));
  EXPECT_DOUBLE_EQ(FreedomOfSum(1, 5, 0, 7), 5);
  EXPECT_DOUBLE_EQ(FreedomOfSum(1, 5, 1, 5), 10);
}

}  // namespace
}  // namespace ballpiston
