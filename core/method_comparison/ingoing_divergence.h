// How far the measured law of ingoing angles is from the exact one, and how far it would be by
// chance alone.
//
// The cells are those of `first-hit`: kIngoingBins bins of alpha for each allowed sign of the
// piston's velocity. Of N samples from the exact law the divergence D is, with many samples a cell,
// a chi-squared one of (cells - 1) degrees of freedom over 2 N:
//   mean (cells - 1)/(2 N), standard deviation sqrt((cells - 1)/2)/N.
// A slow method has fewer samples than cells; NoiseOfDivergence knows their noise too, and tends
// to the above. Property, with a test of its name: 1. NoiseIsThatOfSamplesFromTheLaw, for few
// samples and for many.
#ifndef BALLPISTON_CORE_METHOD_COMPARISON_INGOING_DIVERGENCE_H_
#define BALLPISTON_CORE_METHOD_COMPARISON_INGOING_DIVERGENCE_H_

#include <cstdint>
#include <span>
#include <vector>

#include "core/closed_form/ingoing_law.h"
#include "core/experiment/return_orbits.h"
#include "core/statistics/histogram.h"

namespace ballpiston {

// Of the divergence of `samples` draws from the law with these probabilities from that law.
struct DivergenceNoise {
  double mean;
  double standard_deviation;
};
DivergenceNoise NoiseOfDivergence(uint64_t samples, std::span<const double> probabilities);

// Exact probabilities of the cells, sigma = -1 first, in the order of an IngoingCounts.
std::vector<double> IngoingProbabilities(double epsilon);

class IngoingCounts {
 public:
  explicit IngoingCounts(double epsilon);

  void Add(const Return& hit);

  std::vector<uint64_t> Counts() const;

 private:
  std::vector<Histogram> histograms_;  // by sigma: -1, then +1 where it is allowed
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_METHOD_COMPARISON_INGOING_DIVERGENCE_H_
