// The sampled jump process against the exact law of the pair's exchanges.
#include "core/markov/jump_process.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/closed_form/kernel_moments.h"
#include "core/sampling/counter_random.h"

namespace ballpiston {
namespace {

constexpr uint64_t kSeed = 11;

enum Stream : uint64_t { kMoments = 0, kWaiting = 100, kRelaxation, kPairs, kLag };

// A sample's deviations from the mean it should have.
struct Deviations {
  double exact = 0;
  double count = 0, sum = 0, sum_of_squares = 0;

  void Add(double x) {
    const double deviation = x - exact;
    count += 1, sum += deviation, sum_of_squares += deviation * deviation;
  }
};

// Within 4 standard errors, and the rounding of a sum where nothing scatters.
void ExpectMean(const Deviations& sample) {
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(
      sample.sum, 0,
      4 * std::sqrt(sample.sum_of_squares) + kRounding * sample.count * std::fabs(sample.exact));
}

// Independent first jumps at one energy: the mean waiting time is 1/f, those of the energy zeta
// that the piston gains, and of its square, are j/f and h/f.
void ExpectExactMoments(uint64_t stream, double ep, uint64_t samples) {
  constexpr uint64_t kTogether = 5000;
  const double u = std::sqrt(2 * ep), f = PairCollisionRate(ep);
  Deviations time = {1 / f}, gain = {PairEnergyCurrent(ep) / f},
             squared_gain = {PairSquaredEnergyTransfer(ep) / f};
  for (uint64_t first = 0; first < samples; first += kTogether) {
    JumpWalkers walkers(kSeed, stream, first, std::vector<double>(kTogether, u));
    walkers.Jump();
    for (const double waited : walkers.waiting_times()) time.Add(waited);
    for (const double next : walkers.u()) {
      const double zeta = (next - u) * (next + u) / 2;
      gain.Add(zeta);
      squared_gain.Add(zeta * zeta);
    }
  }
  ExpectMean(time);
  ExpectMean(gain);
  ExpectMean(squared_gain);
}

// 60 comparisons within 4 standard errors: one false alarm in 260 choices of the seed.
TEST(JumpProcess, MomentsOfWAreTheExactOnes) {
  constexpr int kEnergies = 20;
  for (int k = 0; k < kEnergies; ++k) {
    const double ep = 0.5 * k / (kEnergies - 1);  // both ends included
    SCOPED_TRACE(ep);
    ExpectExactMoments(kMoments + static_cast<uint64_t>(k), ep, 10'000'000);
  }
}

// sqrt(N) times the largest distance to the uniform distribution function (Kolmogorov, Smirnov):
// above 2.3 in 5e-5 of all cases.
double DistanceToUniform(std::vector<double> sample) {
  std::sort(sample.begin(), sample.end());
  const auto n = static_cast<double>(sample.size());
  double largest = 0;
  for (size_t i = 0; i < sample.size(); ++i) {
    const auto below = static_cast<double>(i);
    largest = std::max({largest, sample[i] - below / n, (below + 1) / n - sample[i]});
  }
  return largest * std::sqrt(n);
}

TEST(JumpProcess, WaitingTimesAreExponential) {
  for (const double u : {0.0, 0.6, 0.9}) {
    JumpWalkers walkers(kSeed, kWaiting, 0, std::vector<double>(1'000'000, u));
    walkers.Jump();
    std::vector<double> survival;
    for (const double time : walkers.waiting_times()) {
      survival.push_back(std::exp(-PairCollisionRate(u * u / 2) * time));
    }
    EXPECT_LT(DistanceToUniform(survival), 2.3) << u;
  }
}

// Where independent walkers are after a time.
std::vector<double> After(double time, Stream stream, std::vector<double> starts) {
  constexpr size_t kTogether = 5000;
  std::vector<double> reached;
  for (size_t first = 0; first < starts.size(); first += kTogether) {
    const auto begin = starts.begin() + static_cast<std::ptrdiff_t>(first);
    const size_t count = std::min(kTogether, starts.size() - first);
    std::vector<double> now(begin, begin + static_cast<std::ptrdiff_t>(count)), left(count, time);
    JumpWalkers walkers(kSeed, stream, first, now);
    for (size_t under_way = count; under_way > 0;) {
      walkers.Jump();
      for (size_t i = 0; i < count; ++i) {
        if (left[i] <= 0) continue;
        left[i] -= walkers.waiting_times()[i];
        if (left[i] <= 0)
          --under_way;
        else
          now[i] = walkers.u()[i];
      }
    }
    reached.insert(reached.end(), now.begin(), now.end());
  }
  return reached;
}

// The distribution function of Beta(1/2, 1) at 2 ep is sqrt(2 ep) = u: uniform. From a point, with
// the slowest rate above 0.2, what is left of the start after 60 is 1e-5, a hundredth of the error.
TEST(JumpProcess, StationaryLawOfTwiceTheEnergyIsBeta) {
  for (const double start : {0.0, 0.9}) {
    const std::vector<double> us = After(60, kRelaxation, std::vector<double>(1'000'000, start));
    EXPECT_LT(DistanceToUniform(us), 2.3) << start;
  }
}

// Before that time it is not: the test can tell.
TEST(JumpProcess, IsNotStationaryBeforeItRelaxes) {
  EXPECT_GT(DistanceToUniform(After(10, kRelaxation, std::vector<double>(1'000'000, 0.9))), 5);
}

constexpr size_t kCells = 20;

size_t CellOf(double u) { return std::min(static_cast<size_t>(u * kCells), kCells - 1); }

// Asymmetry of a table of counts of pairs: sum of (n_ij - n_ji)^2/(n_ij + n_ji) over i < j, chi^2
// with as many degrees of freedom as pairs of cells, as the normal variable of the same
// probability (Wilson and Hilferty): above 4 in 3e-5 of all cases.
double Asymmetry(const std::vector<double>& counts) {
  double square = 0, degrees = 0;
  for (size_t i = 0; i < kCells; ++i) {
    for (size_t j = 0; j < i; ++j) {
      const double n = counts[i * kCells + j], m = counts[j * kCells + i];
      if (n + m < 20) continue;
      square += (n - m) * (n - m) / (n + m);
      degrees += 1;
    }
  }
  const double width = 2 / (9 * degrees);
  return (std::cbrt(square / degrees) - (1 - width)) / std::sqrt(width);
}

// Uniform starts, thinned to the density of collisions, r(u) by its largest value, so that each
// pair is a transition of equilibrium. The draws are the words before those of the jumps.
TEST(JumpProcess, TransitionsAreInDetailedBalance) {
  constexpr uint64_t kPairsDrawn = 4'000'000;
  const double most = PairCollisionRate(0.5);
  std::vector<double> counts(kCells * kCells), skewed(kCells * kCells);
  for (uint64_t first = 0; first < kPairsDrawn; first += 5000) {
    std::vector<double> starts(5000);
    std::vector<bool> taken(starts.size());
    for (size_t i = 0; i < starts.size(); ++i) {
      CounterRandom random(kSeed, kPairs, first + i);
      starts[i] = random.Uniform();
      taken[i] = random.Uniform() * most < PairCollisionRate(starts[i] * starts[i] / 2);
    }
    JumpWalkers walkers(kSeed, kPairs, first, starts);
    walkers.Jump();
    for (size_t i = 0; i < starts.size(); ++i) {
      const size_t cell = CellOf(starts[i]) * kCells + CellOf(walkers.u()[i]);
      skewed[cell] += 1;
      if (taken[i]) counts[cell] += 1;
    }
  }
  EXPECT_LT(Asymmetry(counts), 4);
  EXPECT_GT(Asymmetry(skewed), 8);  // without the rates: the test can tell
}

// Whatever happens in between.
TEST(JumpProcess, PairsAtATimeApartAreInDetailedBalance) {
  std::vector<double> starts(2'000'000);
  for (size_t i = 0; i < starts.size(); ++i) starts[i] = CounterRandom(kSeed, kLag, i).Uniform();
  const std::vector<double> later = After(5, kLag, starts);
  std::vector<double> counts(kCells * kCells);
  for (size_t i = 0; i < starts.size(); ++i) {
    counts[CellOf(starts[i]) * kCells + CellOf(later[i])] += 1;
  }
  EXPECT_LT(Asymmetry(counts), 4);
}

}  // namespace
}  // namespace ballpiston
