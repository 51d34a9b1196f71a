// The measurements of one block of an experiment, or of several merged blocks.
//
// A plain set of accumulators; the table of an experiment reads them (measurement.h). Merging the
// blocks of a point in the order of their indices gives the same bits, whichever machine computed
// them. Properties, each with a test of its name:
//   1. MergeWithEmptyIsIdentity.  2. MergeKeepsEverySample.
//   3. EveryBlockHasTheShapeOfTheEmptyOne.
//   4. EveryNumberChangesTheDigest.  5. NumbersInAnotherOrderHaveAnotherDigest.
#pragma once

#include <cstdint>
#include <vector>

#include "core/statistics/batch_means.h"
#include "core/statistics/histogram.h"
#include "core/statistics/moments.h"

namespace ballpiston {

struct Health {
  uint64_t escapes = 0;         // orbits that were lost (Collision::escaped): a defect if not 0
  double max_energy_error = 0;  // largest |E/E0 - 1| seen; E0 = 1/2 of a pair

  void Merge(const Health& other);
  friend bool operator==(const Health&, const Health&) = default;
};

struct BlockResult {
  uint64_t samples = 0;  // first hits, ball-piston collisions, or replicas of a gas
  std::vector<Moments> moments = {};
  std::vector<BatchMeans> batch_means = {};
  std::vector<Histogram> histograms = {};
  Health health = {};

  // Requires the same experiment and point on both sides, or one side default-constructed.
  void Merge(const BlockResult& other);
  // Whether `other` can be merged: it has as many accumulators of each kind, and histograms with
  // the same bins.
  bool HasShapeOf(const BlockResult& other) const;
  friend bool operator==(const BlockResult&, const BlockResult&) = default;
};

// A digest of a result: 64 bits that depend on every bit of every number in it.
//
// Two results with the same digest are the same, except with a probability of some 2^-64. A stored
// digest of a chunk lets anybody who computes the chunk again compare the bits. The digest does not
// protect from a person who makes up numbers with a given digest.
uint64_t DigestOf(const BlockResult& result);

}  // namespace ballpiston
