// Tests whether a sample is from a known law, and whether two samples are from the same law: two
// classical tests, whose results are small if the laws are equal. Samples must be independent, also
// of each other.
#pragma once

#include "tests/support/preamble.h"

namespace ballpiston::oracle {

// Compares two histograms over the same cells. The sum over cells of
// (sqrt(M/N) n - sqrt(N/M) m)^2/(n + m), with totals N and M, is distributed as chi^2 with one
// degree of freedom less than cells. The result is the normal variable of the same probability, by
// Wilson's and Hilferty's cube root: above 4 in 3e-5 of all cases. Neighbouring cells are joined
// until they hold kFewest. The score is 0 if all are joined into one.
inline double ChiSquareScore(std::span<const uint64_t> first, std::span<const uint64_t> second) {
  constexpr double kFewest = 20;
  double totals[2] = {0, 0};
  for (const uint64_t n : first) totals[0] += static_cast<double>(n);
  for (const uint64_t n : second) totals[1] += static_cast<double>(n);
  const double ratio = std::sqrt(totals[1] / totals[0]);
  double square = 0, cells = 0, n = 0, m = 0;
  for (size_t i = 0; i < first.size(); ++i) {
    n += static_cast<double>(first[i]), m += static_cast<double>(second[i]);
    if (n + m < kFewest) continue;
    const double difference = ratio * n - m / ratio;
    square += difference * difference / (n + m);
    cells += 1, n = 0, m = 0;
  }
  if (cells < 2) return 0;
  const double degrees = cells - 1, width = 2 / (9 * degrees);
  return (std::cbrt(square / degrees) - (1 - width)) / std::sqrt(width);
}

// Kolmogorov's and Smirnov's: the largest distance between the sample's distribution function and
// `below`, times sqrt(N). It exceeds 2.3 in 5e-5 of all cases.
template <typename Below>
double KolmogorovSmirnov(std::vector<double> sample, Below below) {
  std::sort(sample.begin(), sample.end());
  const auto n = static_cast<double>(sample.size());
  double largest = 0;
  for (size_t i = 0; i < sample.size(); ++i) {
    const double expected = below(sample[i]);
    const auto before = static_cast<double>(i);
    largest = std::max({largest, expected - before / n, (before + 1) / n - expected});
  }
  return largest * std::sqrt(n);
}

// Kolmogorov's and Smirnov's for two samples: the distance of the first one from the distribution
// function of the second one, times sqrt(N M/(N + M)). It exceeds 2.3 in 5e-5 of all cases. No two
// values of the samples may be equal.
inline double KolmogorovSmirnov(const std::vector<double>& first, std::vector<double> second) {
  std::ranges::sort(second);
  const auto n = static_cast<double>(first.size()), m = static_cast<double>(second.size());
  const auto below = [&](double x) {
    return static_cast<double>(std::ranges::upper_bound(second, x) - second.begin()) / m;
  };
  return KolmogorovSmirnov(first, below) * std::sqrt(m / (n + m));
}

}  // namespace ballpiston::oracle
