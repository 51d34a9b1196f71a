#include "core/statistics/kl_divergence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/arithmetic/elementary_functions.h"
#include "core/statistics/cell_noise.h"
#include "core/statistics/group_scatter.h"

namespace ballpiston {
namespace {

double Square(double x) { return x * x; }

CellNoise NoiseOfCells(double samples, std::span<const double> probabilities) {
  CellNoise noise;
  for (const double probability : probabilities) {
    if (probability > 0) noise.Add(NoiseOfCell(samples, probability));
  }
  return noise;
}

// The weight of the scatter of log(p/q). A value within kNoise standard deviations of the noise
// floor is noise, and so is its scatter: it would make the errors of equal laws 5 to 10 % too
// large.
double BeyondNoise(const KlDivergence& measured) {
  constexpr double kNoise = 2;
  const double beyond = measured.value - measured.noise_floor;
  return beyond <= kNoise * measured.noise_error
             ? 0
             : 1 - Square(Square(kNoise * measured.noise_error / beyond));
}

// Sums over the cells of one law.
struct Sums {
  double samples = 0;
  double information = 0;          // n log(n/mu), mu = N q
  double squared_information = 0;  // n log^2(n/mu)
  CellNoise noise;                 // of these under the exact law
  int cells = 0;

  void Add(uint64_t count, double mean) {
    if (count == 0) return;
    const double n = static_cast<double>(count);
    const double log_ratio = mean > 0 ? Log(n / mean) : std::numeric_limits<double>::infinity();
    information += n * log_ratio;
    squared_information += n * Square(log_ratio);
  }

  KlDivergence Divergence() const {
    if (samples == 0) return {.cells = cells};
    KlDivergence kl = {.value = information / samples,
                       .noise_floor = noise.mean / samples,
                       .noise_error = std::sqrt(noise.VarianceOfSum(samples)) / samples,
                       .cells = cells};
    // The variance of log(p/q) over the samples, minus the part that is noise.
    const double scatter = (squared_information - noise.squared) / samples - Square(kl.value);
    kl.standard_error =
        std::sqrt(Square(kl.noise_error) + BeyondNoise(kl) * std::max(scatter, 0.0) / samples);
    return kl;
  }
};

// The sums over rows, as for independent samples, but without a standard error.
KlDivergence OfRows(std::span<const uint64_t> counts, size_t rows) {
  const size_t cells = counts.size() / rows;
  KlDivergence all;
  double samples = 0, noise_variance = 0;
  for (size_t row = 0; row < rows; ++row) {
    const std::span of_row = counts.subspan(row * cells, cells);
    Sums sums;
    for (const uint64_t count : of_row) sums.samples += static_cast<double>(count);
    if (sums.samples == 0) continue;
    const double mean = sums.samples / static_cast<double>(cells);
    for (const uint64_t count : of_row) sums.Add(count, mean);
    sums.noise = NoiseOfCell(sums.samples, 1.0 / static_cast<double>(cells))
                     .Times(static_cast<double>(cells));
    samples += sums.samples;
    all.value += sums.information;
    all.noise_floor += sums.noise.mean;
    all.cells += static_cast<int>(cells);
    noise_variance += sums.noise.VarianceOfSum(sums.samples);
  }
  if (samples == 0) return {};
  all.value /= samples;
  all.noise_floor /= samples;
  all.noise_error = std::sqrt(noise_variance) / samples;
  return all;
}

// log(p/q) less its mean, by cell.
std::vector<double> Deviations(std::span<const uint64_t> counts, size_t rows, double mean) {
  const size_t cells = counts.size() / rows;
  std::vector<double> deviations(counts.size());
  for (size_t i = 0; i < counts.size(); ++i) {
    double of_row = 0;
    for (const uint64_t count : counts.subspan(i / cells * cells, cells)) {
      of_row += static_cast<double>(count);
    }
    const double expected = of_row / static_cast<double>(cells);
    deviations[i] = counts[i] == 0 ? 0 : Log(static_cast<double>(counts[i]) / expected) - mean;
  }
  return deviations;
}

}  // namespace

KlDivergence RelativeEntropy(std::span<const uint64_t> counts,
                             std::span<const double> probabilities) {
  Sums sums;
  for (const uint64_t count : counts) sums.samples += static_cast<double>(count);
  for (size_t i = 0; i < counts.size(); ++i) {
    sums.Add(counts[i], sums.samples * probabilities[i]);
    sums.cells += probabilities[i] > 0;
  }
  sums.noise = NoiseOfCells(sums.samples, probabilities);
  return sums.Divergence();
}

// To second order in the counts' deviations from their means the divergence is a sum of log(p/q)
// over samples, whose variance the groups give, and half a chi-squared. The noise of log(p/q) adds
// twice the variance of the second part to that of the first.
KlDivergence DivergenceWithinRows(std::span<const Histogram> groups, size_t rows) {
  const std::vector<uint64_t> counts = CountsOf(groups);
  KlDivergence kl = OfRows(counts, rows);
  if (!HaveSamples(groups)) return kl;
  const GroupScatter scatter = ScatterOfGroups(groups, rows);
  kl.noise_floor *= scatter.chi_squared;
  kl.noise_error *= std::sqrt(scatter.chi_squared_variance);
  double samples = 0;
  for (const uint64_t count : counts) samples += static_cast<double>(count);
  const double noise = Square(kl.noise_error);
  const double of_logarithm =
      VarianceBetweenGroups(groups, Deviations(counts, rows, kl.value)) / Square(samples);
  const double beyond = BeyondNoise(kl) * std::max(of_logarithm - 2 * noise, 0.0);
  kl.standard_error = std::sqrt(noise + beyond);
  kl.batches = 1 + static_cast<uint64_t>(
                       std::lround(FreedomOfSum(noise, kFreedomOfPairs, beyond, kFreedomOfGroups)));
  return kl;
}

}  // namespace ballpiston
