// Tests whether a sample is from a known law: two classical tests, whose results are small for
// samples of this law. Samples must be independent.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tests/oracle/two_sample.h"

namespace ballpiston::oracle {

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
