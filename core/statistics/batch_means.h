// Batch means: the ratio of two sums from a correlated series, with a valid standard error.
//
// The series is divided into batches. Each batch contributes its sums (numerator, denominator),
// e.g. (time elapsed, collisions counted). The ratio is that of the totals. Its standard error
// follows from the scatter of numerator - ratio * denominator between batches. The error has no
// bias if batches are independent, or long compared with the correlation time. Batches of unequal
// length have the correct weights. Properties, each with a test of its name:
//   1. MergeEqualsSinglePassAndHasAnIdentity: to rounding, and the identity bit for bit.
//   2. BatchesOfUnequalLengthGiveTheRatioOfTotals.
#pragma once

#include <cstdint>
#include <optional>

#include "core/statistics/moments.h"

namespace ballpiston {

struct BatchMeans {
  Moments numerator = {};  // over the batches
  double mean_denominator = 0;
  double c_nd = 0;  // sums of products of deviations from the means
  double c_dd = 0;

  void Add(double numerator, double denominator);  // one batch
  void Merge(const BatchMeans& other);

  uint64_t batches() const { return numerator.count; }

  // Requires a batch and a denominator other than 0.
  std::optional<double> Ratio() const;
  // Requires at least two batches and a denominator other than 0.
  std::optional<double> StandardError() const;
  // How many batches of a normal law would give an error that is as uncertain, as in
  // Moments::EffectiveCount. Rare large numerators make errors uncertain; denominators are assumed
  // to have no larger excess.
  uint64_t EffectiveCount() const { return numerator.EffectiveCount(); }

  friend bool operator==(const BatchMeans&, const BatchMeans&) = default;
};

}  // namespace ballpiston
