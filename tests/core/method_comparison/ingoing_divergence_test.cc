#include "core/method_comparison/ingoing_divergence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/sampling/counter_random.h"
#include "core/statistics/kl_divergence.h"
#include "core/statistics/moments.h"

namespace ballpiston {
namespace {

// Divergences of `samples` draws from the law itself, `repeats` times.
Moments Divergences(const std::vector<double>& probabilities, uint64_t samples, uint64_t repeats) {
  std::vector<double> sums(probabilities.size());
  std::partial_sum(probabilities.begin(), probabilities.end(), sums.begin());
  Moments moments;
  for (uint64_t i = 0; i < repeats; ++i) {
    CounterRandom random(11, samples, i);
    std::vector<uint64_t> counts(sums.size());
    for (uint64_t n = 0; n < samples; ++n) {
      const auto cell = std::upper_bound(sums.begin(), sums.end() - 1, random.Uniform());
      ++counts[static_cast<size_t>(cell - sums.begin())];
    }
    moments.Add(RelativeEntropy(counts, probabilities).value);
  }
  return moments;
}

// 12 comparisons at 4.5 standard errors: one false alarm in 1e4 seeds, and the seed is fixed. The
// scatter's own error is its 1/sqrt(2 repeats), more where it is not that of a Gaussian (by its
// measured kurtosis).
TEST(IngoingDivergence, NoiseIsThatOfSamplesFromTheLaw) {
  for (const double epsilon : {0.125, 0.4}) {
    const std::vector<double> probabilities = IngoingProbabilities(epsilon);
    for (const auto& [samples, repeats] :
         {std::pair<uint64_t, uint64_t>{16, 1000}, {256, 400}, {4096, 100}, {65536, 20}}) {
      const Moments measured = Divergences(probabilities, samples, repeats);
      const DivergenceNoise noise = NoiseOfDivergence(samples, probabilities);
      EXPECT_NEAR(measured.mean, noise.mean, 4.5 * *measured.StandardError()) << samples;
      const double count = static_cast<double>(repeats);
      const double kurtosis = measured.m4 * count / (measured.m2 * measured.m2);
      const double error_of_scatter = std::sqrt(std::fmax(kurtosis - 1, 2) / (4 * count));
      EXPECT_NEAR(std::sqrt(*measured.Variance()) / noise.standard_deviation, 1,
                  4.5 * error_of_scatter)
          << samples;
    }
  }
}

// 1e8 samples in 2000 cells: what the series in samples a cell leaves out is below 1e-4.
TEST(IngoingDivergence, NoiseTendsToThatOfChiSquared) {
  for (const double epsilon : {0.125, 0.4}) {
    const std::vector<double> probabilities = IngoingProbabilities(epsilon);
    const double freedom = static_cast<double>(probabilities.size()) - 1;
    constexpr uint64_t kSamples = 100'000'000;
    const DivergenceNoise noise = NoiseOfDivergence(kSamples, probabilities);
    EXPECT_NEAR(noise.mean * 2 * kSamples / freedom, 1, 2e-3);
    EXPECT_NEAR(noise.standard_deviation * kSamples / std::sqrt(freedom / 2), 1, 2e-3);
  }
}

TEST(IngoingDivergence, ProbabilitiesAreThoseOfAllCells) {
  EXPECT_EQ(IngoingProbabilities(0.125).size(), 2000);
  EXPECT_EQ(IngoingProbabilities(0.3).size(), 1000);
  for (const double epsilon : {0.01, 0.125, 0.3}) {
    const std::vector<double> cells = IngoingProbabilities(epsilon);
    EXPECT_NEAR(std::accumulate(cells.begin(), cells.end(), 0.0), 1, 1e-13);
  }
}

TEST(IngoingDivergence, CountsAreInTheOrderOfTheProbabilities) {
  IngoingCounts counts(0.125);
  counts.Add({.direction = {1, 1e-9}, .sigma = -1});
  counts.Add({.direction = {1, 1e-9}, .sigma = +1});
  EXPECT_EQ(counts.Counts().size(), 2000);
  EXPECT_EQ(counts.Counts()[500], 1);
  EXPECT_EQ(counts.Counts()[1500], 1);
}

}  // namespace
}  // namespace ballpiston
