// Laws of the sampled jump process after many jumps. Single jumps are compared one by one with the
// exact law in core/markov/jump_process_test.cc.
#include "core/markov/jump_process.h"

#include "tests/core/preamble.h"
#include "tests/oracle/one_sample.h"

namespace ballpiston {
namespace {

constexpr uint64_t kSeed = 11;

enum Stream : uint64_t { kRelaxation, kLag };

// Of values u from the uniform law: above 2.3 in 5e-5 of all cases.
double DistanceToUniform(const std::vector<double>& us) {
  return oracle::KolmogorovSmirnov(us, [](double u) { return u; });
}

// The values u of independent walkers after a time.
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

// The distribution function of Beta(1/2, 1) at 2 ep is sqrt(2 ep) = u, so u is uniform. After a
// time 60 the influence of the start has decayed to exp(-0.152 * 60) = 1e-4, a tenth of the error.
TEST(JumpProcess, StationaryLawOfTwiceTheEnergyIsBeta) {
  for (const double start : {0.0, 0.9}) {
    const std::vector<double> us = After(60, kRelaxation, std::vector<double>(1'000'000, start));
    EXPECT_LT(DistanceToUniform(us), 2.3) << start;
  }
}

// The law is not stationary after a time 10, and the test detects it.
TEST(JumpProcess, IsNotStationaryBeforeItRelaxes) {
  EXPECT_GT(DistanceToUniform(After(10, kRelaxation, std::vector<double>(1'000'000, 0.9))), 5);
}

constexpr size_t kCells = 20;

size_t CellOf(double u) { return std::min(static_cast<size_t>(u * kCells), kCells - 1); }

// Counts pairs of cells: the cell of the start, and the cell after a time 5.
std::vector<double> CountsOfPairs(const std::vector<double>& starts) {
  const std::vector<double> later = After(5, kLag, starts);
  std::vector<double> counts(kCells * kCells);
  for (size_t i = 0; i < starts.size(); ++i) {
    counts[CellOf(starts[i]) * kCells + CellOf(later[i])] += 1;
  }
  return counts;
}

// Asymmetry of a table of counts of pairs: the sum of (n_ij - n_ji)^2/(n_ij + n_ji) over i < j. It
// is distributed as chi^2 with one degree of freedom for each pair of cells. The result is its
// normal score, which exceeds 4 in 3e-5 of all cases.
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
  return oracle::NormalScoreOfChiSquare(square, degrees);
}

// u is uniform in equilibrium. With starts of another law the test detects the imbalance.
TEST(JumpProcess, PairsAtATimeApartAreInDetailedBalance) {
  std::vector<double> starts(2'000'000);
  for (size_t i = 0; i < starts.size(); ++i) starts[i] = CounterRandom(kSeed, kLag, i).Uniform();
  EXPECT_LT(Asymmetry(CountsOfPairs(starts)), 4);
  for (double& u : starts) u *= u;
  EXPECT_GT(Asymmetry(CountsOfPairs(starts)), 8);
}

}  // namespace
}  // namespace ballpiston
