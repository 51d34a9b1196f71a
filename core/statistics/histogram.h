// Counts in equal bins over [lower, upper].
//
// Values at or beyond an end count in the bin at that end: a rounded value may leave its interval
// by an ulp, and no sample may be lost. Property, with a test of its name:
//   1. CountsInTheBinThatHoldsTheValue. Merging adds counts, exactly and in any order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ballpiston {

struct Histogram {
  double lower = 0;
  double upper = 0;  // more than `lower`
  std::vector<uint64_t> counts;

  static Histogram OfBins(double lower, double upper, size_t bins);

  size_t BinOf(double x) const;  // x is not NaN
  void Add(double x) { ++counts[BinOf(x)]; }
  // Requires the same bins on both sides.
  void Merge(const Histogram& other);

  uint64_t Total() const;
  double Edge(size_t bin) const;  // lower edge of a bin; Edge(bins) is `upper`

  friend bool operator==(const Histogram&, const Histogram&) = default;
};

}  // namespace ballpiston
