// The measurements of one block of an experiment, or of several merged blocks.
//
// A plain set of accumulators; the table of an experiment reads them (measurement.h). Merging the
// blocks of a point in the order of their indices gives the same bits, whichever machine computed
// them. Where the samples of a point continue each other (chunk_plan.h), a block's result also has
// the state of its group, from which the group's next block starts. Merging keeps the newer state.
// Properties, each with a test of its name:
//   1. MergeKeepsEverySampleAndHasAnIdentity.  2. EqualResultsHaveEqualNumbersAndShapes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
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

// The state that a group of trajectories has reached, in numbers whose meaning the experiment
// knows; empty before the group's first block. Copies share the numbers, which do not change.
class GroupState {
 public:
  GroupState() = default;
  explicit GroupState(std::vector<double> numbers)
      : numbers_(std::make_shared<const std::vector<double>>(std::move(numbers))) {}

  bool empty() const { return numbers_ == nullptr; }
  std::span<const double> numbers() const {
    return empty() ? std::span<const double>() : std::span(*numbers_);
  }
  friend bool operator==(const GroupState& a, const GroupState& b) {
    return a.numbers_ == b.numbers_ || (!a.empty() && !b.empty() && *a.numbers_ == *b.numbers_);
  }

 private:
  std::shared_ptr<const std::vector<double>> numbers_;
};

struct BlockResult {
  uint64_t samples = 0;  // first hits, ball-piston collisions, or replicas of a gas
  std::vector<Moments> moments = {};
  std::vector<BatchMeans> batch_means = {};
  std::vector<Histogram> histograms = {};
  Health health = {};
  std::vector<GroupState> groups = {};  // by group

  // Requires the same experiment and point on both sides, or one side default-constructed.
  void Merge(const BlockResult& other);
  // Whether `other` can be merged: it has as many accumulators of each kind and as many groups,
  // and histograms with the same bins.
  bool HasShapeOf(const BlockResult& other) const;
  friend bool operator==(const BlockResult&, const BlockResult&) = default;
};

}  // namespace ballpiston
