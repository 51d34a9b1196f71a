#include "core/statistics/batch_means.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

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
