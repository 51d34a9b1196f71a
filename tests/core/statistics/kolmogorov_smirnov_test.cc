#include "core/statistics/kolmogorov_smirnov.h"

#include "core/statistics/group_scatter.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

Histogram Counts(std::vector<uint64_t> counts) {
  return {.lower = 0, .upper = 1, .counts = std::move(counts)};
}

// Independent samples: nothing is known of groups.
KolmogorovSmirnov OfIndependent(const Histogram& histogram) {
  return DistanceToUniform(histogram, std::vector<Histogram>(kGroups, Histogram::OfBins(0, 1, 32)));
}

TEST(KolmogorovSmirnov, IsTheLargestDifferenceAtAnEdge) {
  EXPECT_DOUBLE_EQ(OfIndependent(Counts({2, 6, 1, 1})).distance, 0.3);  // 8/10 below 1/2
  EXPECT_DOUBLE_EQ(OfIndependent(Counts({0, 0, 5, 5})).distance, 0.5);  // below, too
  EXPECT_EQ(OfIndependent(Counts({7, 7, 7, 7})).distance, 0);
  const KolmogorovSmirnov of_one = OfIndependent(Counts({1, 0, 0, 0}));
  EXPECT_DOUBLE_EQ(of_one.distance, 0.75);
  EXPECT_GT(of_one.standard_error, 0);
  // At a distance of many noise floors the error is that of a share.
  EXPECT_NEAR(OfIndependent(Counts({200, 600, 100, 100})).standard_error,
              std::sqrt(0.8 * 0.2 / 1000), 0.001);
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
      distances.Add((last = OfIndependent(histogram)).distance);
      errors.Add(last.standard_error);
    }
    EXPECT_NEAR(errors.mean / std::sqrt(*distances.Variance()), 1, 0.1) << bins;
    EXPECT_NEAR(distances.mean, last.noise_floor, 4 * 0.26 / std::sqrt(2000 * 4096.0)) << bins;
  }
}

// Each number of x^power counts `repeats` times.
KolmogorovSmirnov OfRepeated(std::mt19937_64& bits, double power, int samples, uint64_t repeats) {
  Histogram all = Histogram::OfBins(0, 1, 1024);
  std::vector<Histogram> groups(kGroups, Histogram::OfBins(0, 1, 32));
  for (int i = 0; i < samples; ++i) {
    const double x = std::pow(std::ldexp(static_cast<double>(bits() >> 11), -53), power);
    for (uint64_t repeat = 0; repeat < repeats; ++repeat) {
      all.Add(x);
      groups[static_cast<size_t>(i) % kGroups].Add(x);
    }
  }
  return DistanceToUniform(all, groups);
}

// 400 repetitions: a scatter is known to 3.5 %, and the window is 5 of these. For equal laws the
// few large distances make the errors' mean up to 5 % larger.
TEST(KolmogorovSmirnov, ErrorsHoldForCorrelatedSamples) {
  std::mt19937_64 bits(9);
  for (const double power : {1.0, 1.5}) {
    for (const uint64_t repeats : {1, 3}) {
      Moments distances, floors, variances;
      for (int i = 0; i < 400; ++i) {
        const KolmogorovSmirnov measured = OfRepeated(bits, power, 2000, repeats);
        distances.Add(measured.distance);
        floors.Add(measured.noise_floor);
        variances.Add(measured.standard_error * measured.standard_error);
      }
      EXPECT_NEAR(std::sqrt(*distances.Variance() / variances.mean), 1, 0.22) << repeats;
      if (power == 1) {
        EXPECT_NEAR(distances.mean / floors.mean, 1, 0.08) << repeats;
      }
    }
  }
}

}  // namespace
}  // namespace ballpiston
