// Coarse-grained relative entropy of a measured law to an exact one, the paper's eq. kld:
//   D = sum over cells of p log(p/q),  p = counts/samples,  q = exact probability of the cell.
//
// N samples drawn from q itself have a D above 0. The mean of this D (the noise floor) and its
// standard deviation are computed for the given N, cell by cell. The chi-squared law,
// (cells - 1)/(2 N), is not used, because it holds only above about ten samples per cell. Natural
// logarithms. Properties, each with a test of its name:
//   1. NoiseFloorIsTheMeanUnderTheExactLaw, to 1e-3 of itself at every N.
//   2. ErrorsAreTheScatterOfRepetitions, for equal and for unequal laws.
//   3. ErrorsHoldForCorrelatedSamples, of DivergenceWithinRows.
//
// An error is the scatter of D at this N. The mean of D at this N is above its limit of many
// samples; the difference is the noise floor only if the laws are nearly equal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/statistics/histogram.h"

namespace ballpiston {

struct KlDivergence {
  double value = 0;
  double noise_floor = 0;     // mean of `value` if the measured law were equal to the exact law
  double noise_error = 0;     // standard deviation of `value` in this case
  double standard_error = 0;  // of `value`, for any measured law; at least noise_error
  int cells = 0;              // with a probability above 0
  uint64_t batches = 0;       // of standard_error, as in Estimate; 0: those of a normal law
};

// One count for each probability; probabilities sum to 1. If a cell of probability 0 has a count,
// the divergence is infinite. Without samples all fields except `cells` are 0, here and below.
KlDivergence RelativeEntropy(std::span<const uint64_t> counts,
                             std::span<const double> probabilities);

// The divergence of each row's law from the uniform law over the row's cells, averaged over
// samples. This is the divergence of the law given the row. Rows without samples have no weight.
// The cells are counted by group (group_scatter.h), so samples within a group may be correlated.
// While a group is empty there is no standard error, and the noise is that of independent samples.
KlDivergence DivergenceWithinRows(std::span<const Histogram> groups, size_t rows);

}  // namespace ballpiston
