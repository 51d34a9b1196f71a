#include "core/statistics/cell_noise.h"

#include <algorithm>
#include <cmath>

#include "core/arithmetic/elementary_functions.h"

namespace ballpiston {
namespace {

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
  double squared = 1;
  double variance = 0;
  double covariance = 0;
};

// Of Poisson counts.
Scatter ScatterOfCounts(double mu) {
  if (mu >= kManyCounts) return {1, 0.5 + 1 / (6 * mu), -1 / (12 * mu)};
  double mean = 0, square = 0;
  Scatter scatter = {};
  scatter.squared = 0;
  ForEachCount(
      Exp(-mu), LargestCount(mu), [mu](double n) { return mu / (n + 1); },
      [&](double n, double p) {
        const double information = Information(n, mu), h = information - (n - mu);
        if (n > 0) scatter.squared += p * information * information / n;
        mean += p * h;
        square += p * h * h;
        scatter.covariance += p * h * (n - mu);
      });
  scatter.variance = square - mean * mean;
  return scatter;
}

}  // namespace

void CellNoise::Add(const CellNoise& other) {
  mean += other.mean;
  squared += other.squared;
  variance += other.variance;
  covariance += other.covariance;
  curvature += other.curvature;
}

CellNoise CellNoise::Times(double cells) const {
  return {mean * cells, squared * cells, variance * cells, covariance * cells, curvature * cells};
}

double CellNoise::VarianceOfSum(double samples) const {
  const double bend = 1 + curvature;
  return std::max(variance - covariance * covariance / samples - bend * bend / 2, 0.0);
}

CellNoise NoiseOfCell(double samples, double probability) {
  if (samples == 0) return {};
  constexpr double kShift = 0.01;
  const double mu = samples * probability;
  const Scatter scatter = ScatterOfCounts(mu);
  const double more = ScatterOfCounts(mu * (1 + kShift)).covariance / (1 + kShift);
  const double fewer = ScatterOfCounts(mu * (1 - kShift)).covariance / (1 - kShift);
  return {.mean = mu < kManyCounts ? MeanOfFewCounts(samples, probability)
                                   : MeanOfManyCounts(samples, probability),
          .squared = scatter.squared,
          .variance = scatter.variance,
          .covariance = scatter.covariance,
          .curvature = (more - fewer) / (2 * kShift * samples)};
}

}  // namespace ballpiston
