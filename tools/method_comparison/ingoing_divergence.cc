#include "tools/method_comparison/ingoing_divergence.h"

#include "core/experiment/returns.h"

namespace ballpiston::method_comparison {

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

}  // namespace ballpiston::method_comparison
