#include "core/statistics/kolmogorov_smirnov.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/statistics/moments.h"

namespace ballpiston {
namespace {

Histogram Counts(std::vector<uint64_t> counts) {
  return {.lower = 0, .upper = 1, .counts = std::move(counts)};
}

TEST(KolmogorovSmirnov, IsTheLargestDifferenceAtAnEdge) {
  const KolmogorovSmirnov measured = DistanceToUniform(Counts({2, 6, 1, 1}));
  EXPECT_DOUBLE_EQ(measured.distance, 0.3);                                 // 8/10 below 1/2
  EXPECT_DOUBLE_EQ(DistanceToUniform(Counts({0, 0, 5, 5})).distance, 0.5);  // below, too
  EXPECT_EQ(DistanceToUniform(Counts({7, 7, 7, 7})).distance, 0);
}

// At a distance of many noise floors the error is that of a share.
TEST(KolmogorovSmirnov, ErrorFarFromTheUniformLawIsThatOfAShare) {
  const KolmogorovSmirnov measured = DistanceToUniform(Counts({200, 600, 100, 100}));
  EXPECT_NEAR(measured.standard_error, std::sqrt(0.8 * 0.2 / 1000), 0.001);
}

TEST(KolmogorovSmirnov, OneSampleHasADistanceAndAnError) {
  const KolmogorovSmirnov measured = DistanceToUniform(Counts({1, 0, 0, 0}));
  EXPECT_DOUBLE_EQ(measured.distance, 0.75);
  EXPECT_GT(measured.standard_error, 0);
}

// 2000 repetitions: the mean is known to 0.26/sqrt(2000) = 0.006 of 1/sqrt(N), window 4 of these:
// false alarms 6e-5 each. Without the bins' correction the mean would be off by 0.073 and 0.018.
// The scatter is known to 2 %, and the window of the errors' mean, which also depends on the few
// large distances, is 10 %; the error of a share would be 80 % larger.
TEST(KolmogorovSmirnov, NoiseFloorIsTheMeanDistanceOfUniformSamples) {
  std::mt19937_64 bits(5);
  for (const size_t bins : {64u, 1024u}) {
    Moments distances, errors;
    KolmogorovSmirnov last;
    for (int i = 0; i < 2000; ++i) {
      Histogram histogram = Histogram::OfBins(0, 1, bins);
      for (int k = 0; k < 4096; ++k) ++histogram.counts[bits() >> 32 & (bins - 1)];
      distances.Add((last = DistanceToUniform(histogram)).distance);
      errors.Add(last.standard_error);
    }
    EXPECT_NEAR(errors.mean / std::sqrt(*distances.Variance()), 1, 0.1) << bins;
    EXPECT_NEAR(distances.mean, last.noise_floor, 4 * 0.26 / std::sqrt(2000 * 4096.0)) << bins;
  }
}

}  // namespace
}  // namespace ballpiston
