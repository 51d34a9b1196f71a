#include "core/statistics/kl_divergence.h"

#include "core/statistics/group_scatter.h"
#include "core/statistics/kolmogorov_smirnov.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

TEST(KlDivergence, IsTheSumOfPLogPOverQ) {
  struct Case {
    std::vector<uint64_t> counts;
    std::vector<double> probabilities;
    double value, cells;
  };
  for (const Case& row : {Case{{300, 100}, {0.75, 0.25}, 0, 2},
                          {{2, 0, 2}, {0.25, 0.5, 0.25}, std::log(2), 3},
                          {{1, 1}, {1, 0}, HUGE_VAL, 1},  // an impossible count
                          {{0, 0}, {0.5, 0.5}, 0, 2}}) {
    const KlDivergence kl = RelativeEntropy(row.counts, row.probabilities);
    EXPECT_DOUBLE_EQ(kl.value + 1, row.value + 1);
    EXPECT_EQ(kl.cells, row.cells);
  }
}

TEST(KlDivergence, WithoutSamplesIsZero) {
  const std::vector<Histogram> groups(kGroups, Histogram::OfBins(0, 1, 4));
  for (const KlDivergence& kl :
       {RelativeEntropy(std::array<uint64_t, 2>{0, 0}, std::array{0.5, 0.5}),
        DivergenceWithinRows(groups, 2)}) {
    for (const double number : {kl.value, kl.noise_floor, kl.noise_error, kl.standard_error}) {
      EXPECT_EQ(number, 0);
    }
  }
}

// Probabilities that fall by a factor of 1000 from the first cell to the last.
std::vector<double> SteepLaw(size_t cells) {
  std::vector<double> probabilities(cells);
  double sum = 0;
  for (size_t i = 0; i < cells; ++i) {
    sum += probabilities[i] = std::pow(1e-3, static_cast<double>(i) / static_cast<double>(cells));
  }
  for (double& probability : probabilities) probability /= sum;
  return probabilities;
}

// E[n log(n/mu)/N] summed over the cells, from the logarithms of binomial coefficients.
double ExactFloor(uint64_t samples, const std::vector<double>& probabilities) {
  const double count = static_cast<double>(samples);
  double floor = 0;
  for (const double q : probabilities) {
    for (double n = 1; n <= count; ++n) {
      const double log_probability = std::lgamma(count + 1) - std::lgamma(n + 1) -
                                     std::lgamma(count - n + 1) + n * std::log(q) +
                                     (count - n) * std::log1p(-q);
      floor += std::exp(log_probability) * n * std::log(n / (count * q)) / count;
    }
  }
  return floor;
}

// The noise depends on the number of samples, not on their cells.
KlDivergence NoiseOf(uint64_t samples, const std::vector<double>& law) {
  std::vector<uint64_t> counts(law.size());
  counts[0] = samples;
  return RelativeEntropy(counts, law);
}

// Between 0.001 and 10,000 samples a cell; cells that are nearly certain, and nearly impossible.
TEST(KlDivergence, NoiseFloorIsTheMeanUnderTheExactLaw) {
  std::vector<std::vector<double>> laws = {SteepLaw(2), SteepLaw(7), SteepLaw(100)};
  for (const double q : {0.3, 0.01, 1e-5, 1e-9}) laws.push_back({1 - q, q});
  for (const std::vector<double>& law : laws) {
    for (const uint64_t samples :
         {1u, 2u, 3u, 10u, 30u, 100u, 300u, 1000u, 3000u, 10'000u, 20'000u}) {
      if (law.back() < 1e-3 && law.size() == 2 && samples > 1000) continue;
      EXPECT_NEAR(NoiseOf(samples, law).noise_floor / ExactFloor(samples, law), 1, 1e-3)
          << law.size() << " cells, " << samples << " samples";
    }
  }
  EXPECT_NEAR(NoiseOf(10, {1}).noise_floor, 0, 1e-16);
}

class Draw {  // of a cell
 public:
  explicit Draw(const std::vector<double>& law) : sums_(law.size()) {
    std::partial_sum(law.begin(), law.end(), sums_.begin());
  }
  size_t operator()(CounterRandom& random) const {
    const auto cell = std::upper_bound(sums_.begin(), sums_.end() - 1, random.Uniform());
    return static_cast<size_t>(cell - sums_.begin());
  }

 private:
  std::vector<double> sums_;
};

std::vector<double> UniformLaw(size_t cells) {
  return std::vector<double>(cells, 1 / static_cast<double>(cells));
}

// Its probabilities rise from 1 - tilt times those of the uniform law to 1 + tilt times.
std::vector<double> TiltedLaw(size_t cells, double tilt) {
  std::vector<double> law = UniformLaw(cells);
  for (size_t i = 0; i < cells; ++i) {
    law[i] *= 1 + tilt * (2 * (static_cast<double>(i) + 0.5) / static_cast<double>(cells) - 1);
  }
  return law;
}

// Half of its samples are in the first 20 cells, so the other cells hold fewer samples than under
// the uniform law, and less noise.
std::vector<double> PeakedLaw(size_t cells) {
  std::vector<double> law(cells, 0.5 / static_cast<double>(cells));
  for (size_t i = 0; i < 20; ++i) law[i] += 0.5 / 20;
  return law;
}

// The cases are equal laws, with many samples a cell and with few, and unequal laws. A scatter of n
// repetitions has a relative error of 1/sqrt(2 n) if it is that of a Gaussian, and one up to 15 %
// larger here. A window of 5 errors gives up to 2e-5 false alarms. A window of 7 errors, with less
// than 1e-8, is for 16 samples and for unequal laws, whose stated errors are less exact. With 8000
// repetitions the window is 4 %: errors are 5 % or more too large if the noise counts twice. The
// mean of the value is compared within 5 of its standard errors.
TEST(KlDivergence, ErrorsAreTheScatterOfRepetitions) {
  struct Case {
    std::vector<double> drawn, law;
    int samples, repetitions;
    double errors;  // in the window
  };
  for (const Case& row : {Case{UniformLaw(20), UniformLaw(20), 2000, 8000, 5},
                          {UniformLaw(120), UniformLaw(120), 3000, 400, 5},
                          {SteepLaw(1000), SteepLaw(1000), 16, 400, 7},
                          {SteepLaw(1000), SteepLaw(1000), 4096, 400, 5},
                          {TiltedLaw(100, 0.3), UniformLaw(100), 10'000, 400, 7},
                          {TiltedLaw(100, 0.9), UniformLaw(100), 300, 400, 7},
                          {PeakedLaw(1000), UniformLaw(1000), 256, 400, 7}}) {
    SCOPED_TRACE(testing::Message() << row.samples << " samples in " << row.law.size() << " cells");
    CounterRandom random(8, 0, 0);
    const Draw draw(row.drawn);
    Moments values, errors;
    KlDivergence last;
    for (int i = 0; i < row.repetitions; ++i) {
      std::vector<uint64_t> counts(row.law.size());
      for (int n = 0; n < row.samples; ++n) ++counts[draw(random)];
      last = RelativeEntropy(counts, row.law);
      values.Add(last.value);
      errors.Add(last.standard_error);
    }
    const double scatter = std::sqrt(*values.Variance());
    const double window = row.errors / std::sqrt(2.0 * row.repetitions);
    EXPECT_NEAR(errors.mean / scatter, 1, window);
    if (row.drawn != row.law) continue;
    EXPECT_NEAR(last.noise_error / scatter, 1, window);
    EXPECT_NEAR(values.mean, last.noise_floor, 5 * *values.StandardError());
  }
}

// Each sample counts `repeats` times. The law is tilted in each of two rows.
KlDivergence OfRepeatedSamples(CounterRandom& random, double tilt, int samples, uint64_t repeats) {
  constexpr size_t kCells = 20;
  const Draw draw(TiltedLaw(kCells, tilt));
  std::vector<Histogram> groups(kGroups, Histogram::OfBins(0, 1, 2 * kCells));
  for (int i = 0; i < samples; ++i) {
    const size_t row = random.Uniform() < 0.3 ? 0 : kCells;
    groups[static_cast<size_t>(i) % kGroups].counts[row + draw(random)] += repeats;
  }
  return DivergenceWithinRows(groups, 2);
}

// 400 repetitions: a scatter is known to 3.5 %, window 5 of these. The errors' mean counts with
// their squares. Errors of independent samples would be sqrt(3) to 3 times too small.
TEST(KlDivergence, ErrorsHoldForCorrelatedSamples) {
  for (const double tilt : {0.0, 0.3}) {
    for (const uint64_t repeats : {1, 3}) {
      CounterRandom random(6, repeats, 0);
      Moments values, floors, variances;
      for (int i = 0; i < 400; ++i) {
        const KlDivergence kl = OfRepeatedSamples(random, tilt, 4000, repeats);
        values.Add(kl.value);
        floors.Add(kl.noise_floor);
        variances.Add(kl.standard_error * kl.standard_error);
        EXPECT_EQ(kl.cells, 40);
        EXPECT_GE(kl.batches, 16u);
      }
      EXPECT_NEAR(std::sqrt(*values.Variance() / variances.mean), 1, 5 * 0.035) << repeats;
      EXPECT_EQ(values.mean > 2 * floors.mean, tilt > 0);
      if (tilt == 0) {
        EXPECT_NEAR(values.mean, floors.mean, 5 * *values.StandardError());
      }
    }
  }
}

// ---- kolmogorov_smirnov.h ----

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
