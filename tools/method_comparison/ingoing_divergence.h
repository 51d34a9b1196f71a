// Histograms of the ingoing angles of returns, with the cells of `first-hit`: kIngoingBins bins of
// alpha for each allowed sign of the piston's velocity.
#pragma once

#include <cstdint>
#include <vector>

#include "core/closed_form/ingoing_law.h"
#include "core/experiment/returns.h"
#include "core/statistics/histogram.h"

namespace ballpiston::method_comparison {

// Exact probabilities of the cells, sigma = -1 first, in the order of an IngoingCounts.
std::vector<double> IngoingProbabilities(double epsilon);

class IngoingCounts {
 public:
  explicit IngoingCounts(double epsilon);

  void Add(const Return& hit);

  std::vector<uint64_t> Counts() const;

 private:
  std::vector<Histogram> histograms_;  // sigma = -1, then +1 if it is allowed
};

}  // namespace ballpiston::method_comparison
