// Tests whether a sample is from a known law, and whether two samples are from the same law: two
// classical tests, whose results are small if the laws are equal. Samples must be independent, also
// of each other.
#pragma once

#include "tests/support/preamble.h"

namespace ballpiston::oracle {

// Converts a chi^2 into the normal variable of the same probability, by Wilson's and Hilferty's
// cube root. It exceeds 4 in 3e-5 of all cases.
inline double NormalScoreOfChiSquare(double square, double degrees) {
  const double width = 2 / (9 * degrees);
  return (std::cbrt(square / degrees) - (1 - width)) / std::sqrt(width);
}

// Compares two histograms over the same cells. The sum over cells of
// (sqrt(M/N) n - sqrt(N/M) m)^2/(n + m), with totals N and M, is distributed as chi^2 with one
// degree of freedom less than cells. The result is its normal score. Neighbouring cells are joined
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
  return cells < 2 ? 0 : NormalScoreOfChiSquare(square, cells - 1);
}

// Kolmogorov's and Smirnov's: the largest distance of the two distribution functions, times
// sqrt(N M/(N + M)). Above x in 2 exp(-2 x^2) of all cases: above 2.3 in 5e-5.
inline double KolmogorovSmirnov(std::vector<double> first, std::vector<double> second) {
  std::sort(first.begin(), first.end());
  std::sort(second.begin(), second.end());
  const auto n = static_cast<double>(first.size()), m = static_cast<double>(second.size());
  double largest = 0;
  size_t i = 0, j = 0;
  while (i < first.size() && j < second.size()) {
    const double x = std::min(first[i], second[j]);
    while (i < first.size() && first[i] == x) ++i;
    while (j < second.size() && second[j] == x) ++j;
    largest = std::max(largest, std::fabs(static_cast<double>(i) / n - static_cast<double>(j) / m));
  }
  return largest * std::sqrt(n * m / (n + m));
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

// Compares counts with probabilities, which are positive and sum to 1. The result is the normal
// score of the chi^2 sum: above 4 in 3e-5 of all cases. Every expected count should be 5 or more.
inline double ChiSquareScoreOf(std::span<const uint64_t> counts,
                               std::span<const double> probabilities) {
  double total = 0, square = 0;
  for (const uint64_t n : counts) total += static_cast<double>(n);
  for (size_t i = 0; i < counts.size(); ++i) {
    const double expected = total * probabilities[i];
    square += std::pow(static_cast<double>(counts[i]) - expected, 2) / expected;
  }
  return NormalScoreOfChiSquare(square, static_cast<double>(counts.size()) - 1);
}

}  // namespace ballpiston::oracle
