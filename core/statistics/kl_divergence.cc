#include "core/statistics/kl_divergence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "core/arithmetic/elementary_functions.h"
#include "core/statistics/cumulants.h"
#include "core/statistics/group_scatter.h"

namespace ballpiston {
namespace {

// ---- the noise of the count of one cell ----

// The statistical noise of the count n of one cell, which has probability q, in N samples: the
// moments of n log(n/mu), mu = N q. Their sums over all cells give the noise of a relative entropy.
//
// The sum over all cells is H = sum of h, h = n log(n/mu) - (n - mu). The mean of H is computed
// from the binomial counts, exactly. The variance is that of independent Poisson counts, given that
// their sum T is N. It follows from an expansion of E(H | T) about N. The slope is that of E(H) in
// N, covariance/N; the curvature c is that of E(H) plus 1/N. T has variance N, so
//   variance(H | T = N) = variance - covariance^2/N - (N c)^2/2.
// With many samples per cell this tends to (cells - 1)/2, as for a chi-squared law.
//
// Summed over cells.
struct CellNoise {
  double mean = 0;        // of n log(n/mu), for binomial counts; exact to 1e-4 of itself
  double variance = 0;    // of h, for Poisson counts, like the rest
  double covariance = 0;  // of h and n
  double curvature = 0;   // N d/dN (covariance/N)

  void Add(const CellNoise& other) {
    mean += other.mean;
    variance += other.variance;
    covariance += other.covariance;
    curvature += other.curvature;
  }

  CellNoise Times(double cells) const {
    return {mean * cells, variance * cells, covariance * cells, curvature * cells};
  }

  // Given T = samples.
  double VarianceOfSum(double samples) const {
    const double bend = 1 + curvature;
    return std::max(variance - covariance * covariance / samples - bend * bend / 2, 0.0);
  }
};

// For expected counts of at least this number, series in 1/mu are exact to 1e-4.
constexpr double kManyCounts = 100;

double Information(double n, double mu) { return n == 0 ? 0 : n * Log(n / mu); }

// log(1 - q), q <= 1/2.
double LogOfRest(double q) { return q < 1e-4 ? -q * (1 + q * (0.5 + q / 3)) : Log(1 - q); }

// A count of mean mu is larger than this with a probability below 1e-17.
double LargestCount(double mu) { return mu + 9 * std::sqrt(mu) + 30; }

// Calls f(n, probability of n) for n = 0 ... last, where p(n + 1) = p(n) ratio(n).
template <typename Ratio, typename F>
void ForEachCount(double none, double last, Ratio ratio, F f) {
  double p = none;
  for (double n = 0; n <= last; ++n) {
    f(n, p);
    p *= ratio(n);
  }
}

// E[n log(n/mu)] of the binomial law. Sums over the count in the cell or outside, whichever is
// rarer.
double MeanOfFewCounts(double samples, double q) {
  const double rarer = std::min(q, 1 - q), odds = rarer / (1 - rarer);
  const auto ratio = [&](double n) { return (samples - n) / (n + 1) * odds; };
  double mean = 0;
  ForEachCount(Exp(samples * LogOfRest(rarer)), std::min(samples, LargestCount(samples * rarer)),
               ratio, [&](double n, double p) {
                 mean += p * Information(q <= 0.5 ? n : samples - n, samples * q);
               });
  return mean;
}

// MeanOfFewCounts from log(1 + x) = x - x^2/2 + ..., n = mu (1 + x), and the law's central moments.
double MeanOfManyCounts(double samples, double q) {
  const double mu = samples * q, p = 1 - q;
  const double m2 = mu * p, m3 = m2 * (1 - 2 * q), m4 = 3 * m2 * m2 + m2 * (1 - 6 * q * p);
  const double m5 = 10 * m2 * m3, m6 = 15 * m2 * m2 * m2;
  return (m2 / 2 + (-m3 / 6 + (m4 / 12 + (-m5 / 20 + m6 / 30 / mu) / mu) / mu) / mu) / mu;
}

struct Scatter {
  double variance = 0;
  double covariance = 0;
};

// Of Poisson counts.
Scatter ScatterOfCounts(double mu) {
  if (mu >= kManyCounts) return {0.5 + 1 / (6 * mu), -1 / (12 * mu)};
  double mean = 0, square = 0;
  Scatter scatter = {};
  ForEachCount(
      Exp(-mu), LargestCount(mu), [mu](double n) { return mu / (n + 1); },
      [&](double n, double p) {
        const double h = Information(n, mu) - (n - mu);
        mean += p * h;
        square += p * h * h;
        scatter.covariance += p * h * (n - mu);
      });
  scatter.variance = square - mean * mean;
  return scatter;
}

// samples 0 (no noise) or at least 1, 0 < probability <= 1.
CellNoise NoiseOfCell(double samples, double probability) {
  if (samples == 0) return {};
  constexpr double kShift = 0.01;
  const double mu = samples * probability;
  const Scatter scatter = ScatterOfCounts(mu);
  const double more = ScatterOfCounts(mu * (1 + kShift)).covariance / (1 + kShift);
  const double fewer = ScatterOfCounts(mu * (1 - kShift)).covariance / (1 - kShift);
  return {.mean = mu < kManyCounts ? MeanOfFewCounts(samples, probability)
                                   : MeanOfManyCounts(samples, probability),
          .variance = scatter.variance,
          .covariance = scatter.covariance,
          .curvature = (more - fewer) / (2 * kShift * samples)};
}

// ---- relative entropies ----

double Square(double x) { return x * x; }

CellNoise NoiseOfCells(double samples, std::span<const double> probabilities) {
  CellNoise noise;
  for (const double probability : probabilities) {
    if (probability > 0) noise.Add(NoiseOfCell(samples, probability));
  }
  return noise;
}

// The weight of the variance beyond that of noise. A value within kNoise standard deviations of the
// noise floor is noise, and so is its variance beyond: it would make the errors of equal laws 5 to
// 10 % too large.
double BeyondNoise(const KlDivergence& measured) {
  constexpr double kNoise = 2;
  const double beyond = measured.value - measured.noise_floor;
  return beyond <= kNoise * measured.noise_error
             ? 0
             : 1 - Square(Square(kNoise * measured.noise_error / beyond));
}

// Sums over the cells of one law.
//
// The variance of H = sum of f(n), f(n) = n log(n/mu), has a part of each order k in the cells'
// k-th differences of f. The jackknife, N times the variance over samples of f(n) - f(n - 1),
// counts the part of order k k times; pairs of samples count it k(k - 1)/2 times. So the jackknife
// minus the pairs has the first two parts right, for any law. The first dominates for unequal laws,
// the second for equal ones.
struct Sums {
  double samples = 0;
  double information = 0;      // f
  double removed = 0;          // n (f(n) - f(n - 1))
  double squared_removed = 0;  // n (f(n) - f(n - 1))^2
  double pairs = 0;            // n (n - 1)/2 (f(n) - 2 f(n - 1) + f(n - 2))^2
  CellNoise noise;             // under the exact law
  int cells = 0;

  void Add(uint64_t count, double mean) {
    if (count == 0) return;
    if (mean <= 0) {
      information = std::numeric_limits<double>::infinity();
      return;
    }
    const double n = static_cast<double>(count);
    const double last = Information(n, mean) - Information(n - 1, mean);
    information += Information(n, mean);
    removed += n * last;
    squared_removed += n * Square(last);
    if (count == 1) return;
    const double before = Information(n - 1, mean) - Information(n - 2, mean);
    pairs += n < kManyCounts ? n * (n - 1) / 2 * Square(last - before) : 0.5;  // without rounding
  }

  KlDivergence Divergence() const {
    if (samples == 0) return {.cells = cells};
    KlDivergence kl = {.value = information / samples,
                       .noise_floor = noise.mean / samples,
                       .noise_error = std::sqrt(noise.VarianceOfSum(samples)) / samples,
                       .cells = cells};
    const double jackknife = squared_removed - Square(removed) / samples;
    const double variance = (jackknife - pairs) / Square(samples);
    const double of_noise = Square(kl.noise_error);
    kl.standard_error = std::sqrt(of_noise + BeyondNoise(kl) * std::max(variance - of_noise, 0.0));
    return kl;
  }
};

double Total(std::span<const uint64_t> counts) {
  double total = 0;
  for (const uint64_t count : counts) total += static_cast<double>(count);
  return total;
}

// The divergence of each row's law from the uniform law, averaged over samples.
double ValueOfRows(std::span<const uint64_t> counts, size_t rows) {
  const size_t cells = counts.size() / rows;
  double information = 0;
  for (size_t row = 0; row < rows; ++row) {
    const std::span of_row = counts.subspan(row * cells, cells);
    const double mean = Total(of_row) / static_cast<double>(cells);
    for (const uint64_t count : of_row) {
      if (count > 0) information += Information(static_cast<double>(count), mean);
    }
  }
  return information / Total(counts);
}

// With the noise of independent samples, and without a standard error.
KlDivergence OfRows(std::span<const uint64_t> counts, size_t rows) {
  const double samples = Total(counts);
  if (samples == 0) return {};
  const size_t cells = counts.size() / rows;
  const auto of_cells = static_cast<double>(cells);
  KlDivergence all = {.value = ValueOfRows(counts, rows)};
  double noise_variance = 0;
  for (size_t row = 0; row < rows; ++row) {
    const double of_row = Total(counts.subspan(row * cells, cells));
    if (of_row == 0) continue;
    const CellNoise noise = NoiseOfCell(of_row, 1 / of_cells).Times(of_cells);
    all.noise_floor += noise.mean / samples;
    all.cells += static_cast<int>(cells);
    noise_variance += noise.VarianceOfSum(of_row);
  }
  all.noise_error = std::sqrt(noise_variance) / samples;
  return all;
}

// The variance by a jackknife over groups. As in Sums, it counts pairs of samples of different
// groups twice.
double JackknifeVariance(std::span<const Histogram> groups, std::span<const uint64_t> counts,
                         size_t rows) {
  const auto without = [&](size_t group) {
    std::vector<uint64_t> others(counts.begin(), counts.end());
    if (group < kGroups) {
      std::ranges::transform(counts, groups[group].counts, others.begin(), std::minus<>());
    }
    return ValueOfRows(others, rows);
  };
  return Square(Jackknife(kGroups, without).error);
}

}  // namespace

KlDivergence RelativeEntropy(std::span<const uint64_t> counts,
                             std::span<const double> probabilities) {
  Sums sums;
  sums.samples = Total(counts);
  for (size_t i = 0; i < counts.size(); ++i) {
    sums.Add(counts[i], sums.samples * probabilities[i]);
    sums.cells += probabilities[i] > 0;
  }
  sums.noise = NoiseOfCells(sums.samples, probabilities);
  return sums.Divergence();
}

KlDivergence DivergenceWithinRows(std::span<const Histogram> groups, size_t rows) {
  const std::vector<uint64_t> counts = CountsOf(groups);
  KlDivergence kl = OfRows(counts, rows);
  if (!HaveSamples(groups)) return kl;
  const GroupScatter scatter = ScatterOfGroups(groups, rows);
  const double of_pairs = scatter.of_pairs * Square(kl.noise_error);
  const double noise = of_pairs + scatter.of_orbits * Square(kl.noise_error);
  kl.noise_floor *= scatter.chi_squared;
  kl.noise_error = std::sqrt(noise);
  // The variance is the jackknife less the pairs. What exceeds the noise is from unequal laws.
  const double jackknife = JackknifeVariance(groups, counts, rows);
  const double beyond = BeyondNoise(kl) * std::max(jackknife - of_pairs - noise, 0.0);
  kl.standard_error = std::sqrt(noise + beyond);
  kl.batches = 1 + static_cast<uint64_t>(std::lround(FreedomOfSum(
                       of_pairs, kFreedomOfPairs, noise - of_pairs + beyond, kFreedomOfGroups)));
  return kl;
}

}  // namespace ballpiston
