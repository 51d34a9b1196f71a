#include "core/statistics/moments.h"

#include "core/statistics/batch_means.h"
#include "core/statistics/cumulants.h"
#include "core/statistics/histogram.h"
#include "core/statistics/stated_error.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// Skewed and far from 0, so that wrong updates of the third moment or of the mean show.
std::vector<double> SkewedSample(size_t size) {
  CounterRandom random(7, 0, 0);
  std::vector<double> xs(size);
  for (double& x : xs) x = 1000 - std::log(random.Uniform());
  return xs;
}

Moments Of(const std::vector<double>& xs, size_t begin, size_t end) {
  Moments moments;
  for (size_t i = begin; i < end; ++i) moments.Add(xs[i]);
  return moments;
}

void ExpectNear(const Moments& a, const Moments& b) {
  // Sums of 1e4 terms, rounded in another order: some 1e-16 sqrt(1e4) of the largest partial sums.
  EXPECT_EQ(a.count, b.count);
  EXPECT_NEAR(a.mean, b.mean, 1e-13 * std::fabs(b.mean));
  EXPECT_NEAR(a.m2, b.m2, 1e-10 * b.m2);
  EXPECT_NEAR(a.m3, b.m3, 1e-9 * std::fabs(b.m3));
  EXPECT_NEAR(a.m4, b.m4, 1e-9 * b.m4);
}

TEST(Moments, MergedPassesEqualTwoPasses) {
  const std::vector<double> xs = SkewedSample(10'000);
  long double mean = 0, m2 = 0, m3 = 0, m4 = 0;
  for (const double x : xs) mean += x;
  mean /= static_cast<long double>(xs.size());
  for (const double x : xs) {
    const long double d = x - mean;
    m2 += d * d;
    m3 += d * d * d;
    m4 += d * d * d * d;
  }
  const Moments expected = {xs.size(), static_cast<double>(mean), static_cast<double>(m2),
                            static_cast<double>(m3), static_cast<double>(m4)};
  ExpectNear(Of(xs, 0, xs.size()), expected);
  Moments merged = Of(xs, 0, 17);
  merged.Merge(Of(xs, 17, 4000));
  merged.Merge(Of(xs, 4000, xs.size()));
  ExpectNear(merged, expected);
  Moments copy;
  copy.Merge(merged);
  copy.Merge({});
  EXPECT_EQ(copy, merged);
}

TEST(Moments, TooFewSamplesHaveNoError) {
  Moments one;
  EXPECT_FALSE(one.StandardError());
  one.Add(3);
  EXPECT_FALSE(one.StandardError());
  EXPECT_FALSE(one.CoefficientOfVariation());
  EXPECT_FALSE(one.CoefficientOfVariationError());
  one.Add(5);
  EXPECT_DOUBLE_EQ(*one.StandardError(), 1);
  EXPECT_DOUBLE_EQ(*one.CoefficientOfVariation(), std::sqrt(2.0) / 4);
}

// The excess kurtosis of numbers +-1 is -2, that of an exponential law 6, of which a sample shows a
// little less.
TEST(Moments, EffectiveCountIsThatOfANormalLaw) {
  Moments signs;
  for (int i = 0; i < 64; ++i) signs.Add(i % 2 == 0 ? -1 : 1);
  EXPECT_EQ(signs.EffectiveCount(), 64u);
  const Moments skewed = Of(SkewedSample(100'000), 0, 100'000);
  EXPECT_NEAR(static_cast<double>(skewed.EffectiveCount()) / 100'000, 0.25, 0.03);
  Moments one;
  EXPECT_EQ(one.EffectiveCount(), 0u);
  one.Add(3);
  EXPECT_EQ(one.EffectiveCount(), 1u);
  one.Add(3);
  EXPECT_EQ(one.EffectiveCount(), 2u);
}

// ---- cumulants.h ----

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

// ---- histogram.h ----

// Values at or beyond an end are counted in its bin.
TEST(Histogram, CountsInTheBinThatHoldsTheValue) {
  Histogram inside = Histogram::OfBins(-1, 1, 4), beyond = inside;
  for (const double x : {-1.0, -0.51, -0.5, -0.01, 0.0, 0.49, 0.5, 0.99}) inside.Add(x);
  EXPECT_EQ(inside.counts, (std::vector<uint64_t>{2, 2, 2, 2}));
  for (const double x : {1.0, std::nextafter(1.0, 2.0), std::nextafter(-1.0, -2.0)}) beyond.Add(x);
  EXPECT_EQ(beyond.counts, (std::vector<uint64_t>{1, 0, 0, 2}));
  beyond.Merge(inside);
  EXPECT_EQ(beyond.counts, (std::vector<uint64_t>{3, 2, 2, 4}));
  EXPECT_EQ(beyond.Total(), 11u);
}

// ---- stated_error.h ----

TEST(StatedError, NeedsEvents) {
  EXPECT_EQ(StatedError(50, 1, 0.1), 0.1);
  EXPECT_FALSE(StatedError(49.9, 1, 0.1));
  EXPECT_FALSE(StatedError(1e6, 1, {}));
}

TEST(StatedError, IsAtLeastTheRoundingOfTheValue) {
  EXPECT_EQ(StatedError(64, -2, 0), 2 * kRoundingOfAMean);
  EXPECT_EQ(StatedError(64, 2, 1e-16), 2 * kRoundingOfAMean);
  EXPECT_EQ(StatedError(64, 2, 1e-13), 1e-13);
  EXPECT_EQ(StatedError(64, 0, 0), 0);
}

// ---- batch_means.h ----

TEST(BatchMeans, MergeEqualsSinglePassAndHasAnIdentity) {
  CounterRandom random(3, 0, 0);
  BatchMeans whole, first, second;
  for (int i = 0; i < 1000; ++i) {
    const double denominator = 1 + random.Uniform(),
                 numerator = denominator * (50 + random.Uniform());
    whole.Add(numerator, denominator);
    (i < 300 ? first : second).Add(numerator, denominator);
  }
  first.Merge(second);
  EXPECT_EQ(first.batches(), whole.batches());
  // Rounding of sums of 1000 terms in another order.
  EXPECT_NEAR(*first.Ratio(), *whole.Ratio(), 1e-13 * *whole.Ratio());
  EXPECT_NEAR(*first.StandardError(), *whole.StandardError(), 1e-9 * *whole.StandardError());
  BatchMeans copy;
  copy.Merge(whole);
  copy.Merge({});
  EXPECT_EQ(copy, whole);
}

TEST(BatchMeans, BatchesOfUnequalLengthGiveTheRatioOfTotals) {
  BatchMeans batches;
  EXPECT_FALSE(batches.Ratio());
  batches.Add(10, 1);
  EXPECT_FALSE(batches.StandardError());
  batches.Add(60, 3);
  EXPECT_DOUBLE_EQ(*batches.Ratio(), 70.0 / 4);
  // Residuals -7.5 and +7.5 about the ratio: sqrt(2 (112.5)/(2 1))/(2) by hand.
  EXPECT_DOUBLE_EQ(*batches.StandardError(), std::sqrt(2 * 7.5 * 7.5 / 2) / 2);
  BatchMeans empty;
  empty.Add(1, 0);
  EXPECT_FALSE(empty.Ratio());
}

TEST(BatchMeans, RareLargeNumeratorsMakeTheErrorUncertain) {
  BatchMeans even, rare;
  for (int i = 0; i < 1000; ++i) {
    even.Add(i % 2, 1);
    rare.Add(i % 100 == 0 ? 100 : 1, 1);
  }
  EXPECT_EQ(even.EffectiveCount(), 1000u);
  EXPECT_LT(rare.EffectiveCount(), 30u);  // the excess is about 95: 2 1000/95
}

}  // namespace
}  // namespace ballpiston
