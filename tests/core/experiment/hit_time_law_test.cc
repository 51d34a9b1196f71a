#include "core/experiment/hit_time_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/core/one_point_spec.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

TEST(HitTimeLaw, ExponentialProbabilitiesSumToOneAndHaveMeanOne) {
  const std::vector<double> p = ExponentialBinProbabilities();
  EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1, 1e-14);
  double mean = 0;
  const double width = kHitTimeMeans / kHitTimeBins;
  for (size_t bin = 0; bin < p.size(); ++bin) {
    mean += p[bin] * (static_cast<double>(bin) + 0.5) * width;
  }
  // The last bin lacks exp(-8) of a mean; the middles of bins are off by width^2/12.
  EXPECT_NEAR(mean, 1, 1e-3);
}

// The same times as those of the mean.
TEST(HitTimeLaw, CountsEachFirstHitInTheBinOfItsTime) {
  for (const double exponent : {0.0, 1.0, 10.0}) {
    const PointSummary summary = RunPoint(
        SpecOf(&kFirstHit, PaperPoint(0.2, 0.125, exponent), {.samples = 5'000}, Model::kBilliard));
    const NamedHistogram& law = summary.histograms.back();
    EXPECT_EQ(law.name, "hit_time");
    EXPECT_EQ(law.histogram.Total(), 5'000u);
    EXPECT_EQ(law.histogram.lower, 0);
    double sum = 0;
    for (size_t bin = 0; bin < kHitTimeBins; ++bin) {
      sum += static_cast<double>(law.histogram.counts[bin]) *
             (law.histogram.Edge(bin) + law.histogram.Edge(bin + 1)) / 2;
    }
    // Within a bin times are spread evenly, nearly: 0.003 of the mean. Some in 3,000 are later.
    EXPECT_NEAR(sum / 5'000 / summary.estimates[0].value, 1, 0.01) << exponent;
  }
}

TEST(HitTimeLaw, TheDivergenceOfTheAngleLeavesTimesOut) {
  const PointSummary summary =
      RunPoint(SpecOf(&kFirstHit, PaperPoint(0.2, 0.3, 1), {.samples = 1'000}, Model::kBilliard));
  ASSERT_EQ(summary.histograms.size(), 2u);
  EXPECT_EQ(summary.kl_divergence->cells, 1000);
}

}  // namespace
}  // namespace ballpiston
