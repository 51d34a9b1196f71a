#include "core/method_comparison/ingoing_divergence.h"

#include <cmath>

#include "core/experiment/ingoing_cells.h"

namespace ballpiston {
namespace {

// The noise. With counts n in cells of q each,
//   2 N D = G = sum of g(n, N q),   g(n, m) = 2 (n log(n/m) - n + m).
// Were the counts independent Poisson numbers, mean, variance and covariance of G with their sum T
// would be sums over cells. Given T = N, expand E(G | T) about N: its slope is that of E(G) in N,
// covariance/N, and its curvature c that of E(G) plus 2/N, which g(T, N) adds. T has variance N, so
//   mean = E(G) - N c/2,   variance = Var(G) - covariance^2/N - (N c)^2/2.
// With many samples a cell N c = 2, with few 0.
struct PoissonNoise {
  double mean = 0;
  double variance = 0;
  double covariance = 0;  // with the count
};

// Beyond it the series in 1/m: what it leaves out is below 1e-3 of what a cell contributes.
constexpr double kManySamples = 30;

PoissonNoise NoiseOfCell(double m) {
  if (m > kManySamples) return {1 + 1 / (6 * m), 2 + 2 / (3 * m), -1 / (6 * m)};
  const double last = m + 12 * std::sqrt(m) + 20;
  double weight = std::exp(-m), square = 0;
  PoissonNoise noise;
  for (double n = 0; n <= last; ++n) {
    const double g = n == 0 ? 2 * m : 2 * (n * std::log(n / m) - n + m);
    noise.mean += weight * g;
    noise.covariance += weight * g * (n - m);
    square += weight * g * g;
    weight *= m / (n + 1);
  }
  noise.variance = square - noise.mean * noise.mean;
  return noise;
}

PoissonNoise NoiseOfCells(double samples, std::span<const double> probabilities) {
  PoissonNoise noise;
  for (const double probability : probabilities) {
    if (probability <= 0) continue;
    const PoissonNoise cell = NoiseOfCell(samples * probability);
    noise.mean += cell.mean;
    noise.variance += cell.variance;
    noise.covariance += cell.covariance;
  }
  return noise;
}

// Of E(G) in N.
double Slope(double samples, std::span<const double> probabilities) {
  return NoiseOfCells(samples, probabilities).covariance / samples;
}

}  // namespace

DivergenceNoise NoiseOfDivergence(uint64_t samples, std::span<const double> probabilities) {
  constexpr double kShift = 0.01;
  const double count = static_cast<double>(samples);
  const PoissonNoise noise = NoiseOfCells(count, probabilities);
  const double change =
      Slope(count * (1 + kShift), probabilities) - Slope(count * (1 - kShift), probabilities);
  const double curvature = change / (2 * kShift) + 2;  // times N
  const double variance =
      noise.variance - noise.covariance * noise.covariance / count - curvature * curvature / 2;
  return {(noise.mean - curvature / 2) / (2 * count),
          std::sqrt(std::fmax(variance, 0)) / (2 * count)};
}

std::vector<double> IngoingProbabilities(double epsilon) {
  std::vector<double> probabilities;
  for (const std::vector<double>& bins : IngoingBinProbabilities(IngoingLaw(epsilon))) {
    probabilities.insert(probabilities.end(), bins.begin(), bins.end());
  }
  return probabilities;
}

IngoingCounts::IngoingCounts(double epsilon)
    : histograms_(EmptyIngoingHistograms(IngoingLaw(epsilon))) {}

void IngoingCounts::Add(const Return& hit) { CountIngoing(hit, histograms_); }

std::vector<uint64_t> IngoingCounts::Counts() const {
  std::vector<uint64_t> counts;
  for (const Histogram& histogram : histograms_) {
    counts.insert(counts.end(), histogram.counts.begin(), histogram.counts.end());
  }
  return counts;
}

}  // namespace ballpiston
