// Tests of the two-sample tests: results are small for samples of one law, large for two laws.
#include "tests/oracle/two_sample.h"

#include "tests/core/preamble.h"

namespace ballpiston::oracle {
namespace {

// Lifetimes of mean 1 + shift.
std::vector<double> Lifetimes(uint64_t stream, size_t count, double shift) {
  CounterRandom random(11, stream, 0);
  std::vector<double> sample(count);
  for (double& x : sample) x = -(1 + shift) * std::log(random.Uniform());
  return sample;
}

std::vector<uint64_t> Histogrammed(const std::vector<double>& sample) {
  std::vector<uint64_t> counts(200);  // the last ones hold few, if any
  for (const double x : sample) ++counts[static_cast<size_t>(std::min(x * 20, 199.0))];
  return counts;
}

// Scores of 400 pairs: normal, so mean 0 +- 0.05 and variance 1 +- 0.07; windows of 4 errors.
TEST(ChiSquareScore, IsNormalForSamplesOfOneLaw) {
  Moments scores;
  for (uint64_t i = 0; i < 400; ++i) {
    scores.Add(ChiSquareScore(Histogrammed(Lifetimes(2 * i, 20'000, 0)),
                              Histogrammed(Lifetimes(2 * i + 1, 30'000, 0))));
  }
  EXPECT_NEAR(scores.mean, 0, 4 * 0.05);
  EXPECT_NEAR(*scores.Variance(), 1, 4 * 0.07);
}

// Kolmogorov's law has mean sqrt(pi/2) log 2 = 0.8687, standard deviation 0.26.
TEST(KolmogorovSmirnov, HasKolmogorovsMeanForSamplesOfOneLaw) {
  Moments values;
  for (uint64_t i = 0; i < 400; ++i) {
    values.Add(KolmogorovSmirnov(Lifetimes(2 * i, 8'000, 0), Lifetimes(2 * i + 1, 12'000, 0)));
  }
  EXPECT_NEAR(values.mean, 0.8687, 4 * 0.013);
}

TEST(TwoSamples, DifferentLawsAreDetected) {
  const std::vector<double> first = Lifetimes(0, 100'000, 0), second = Lifetimes(1, 100'000, 0.05);
  EXPECT_GT(ChiSquareScore(Histogrammed(first), Histogrammed(second)), 4);
  EXPECT_GT(KolmogorovSmirnov(first, second), 2.3);
}

}  // namespace
}  // namespace ballpiston::oracle
