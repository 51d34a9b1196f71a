#include "core/statistics/kl_divergence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/arithmetic/elementary_functions.h"
#include "core/statistics/cell_noise.h"

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
    kl.standard_error = std::sqrt(Square(kl.noise_error) + std::max(scatter, 0.0) / samples);
    return kl;
  }
};

Sums OfUniform(std::span<const uint64_t> counts) {
  Sums sums;
  for (const uint64_t count : counts) sums.samples += static_cast<double>(count);
  const double cells = static_cast<double>(counts.size()), mean = sums.samples / cells;
  for (const uint64_t count : counts) sums.Add(count, mean);
  sums.noise = NoiseOfCell(sums.samples, 1 / cells).Times(cells);
  sums.cells = static_cast<int>(counts.size());
  return sums;
}

}  // namespace

DivergenceNoise NoiseOfDivergence(uint64_t samples, std::span<const double> probabilities) {
  const double count = static_cast<double>(samples);
  const CellNoise noise = NoiseOfCells(count, probabilities);
  return {noise.mean / count, std::sqrt(noise.VarianceOfSum(count)) / count};
}

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

KlDivergence DivergenceFromUniform(std::span<const Histogram> rows) {
  std::vector<uint64_t> counts;
  for (const Histogram& row : rows)
    counts.insert(counts.end(), row.counts.begin(), row.counts.end());
  return OfUniform(counts).Divergence();
}

KlDivergence DivergenceWithinRows(std::span<const Histogram> rows) {
  double samples = 0, noise_variance = 0, variance = 0;
  KlDivergence all;
  for (const Histogram& row : rows) samples += static_cast<double>(row.Total());
  for (const Histogram& row : rows) {
    if (row.Total() == 0) continue;
    const KlDivergence kl = OfUniform(row.counts).Divergence();
    const double share = static_cast<double>(row.Total()) / samples;
    all.value += share * kl.value;
    all.noise_floor += share * kl.noise_floor;
    all.cells += kl.cells;
    noise_variance += Square(share * kl.noise_error);
    variance += Square(share * kl.standard_error);
  }
  all.noise_error = std::sqrt(noise_variance);
  all.standard_error = std::sqrt(variance);
  return all;
}

}  // namespace ballpiston
