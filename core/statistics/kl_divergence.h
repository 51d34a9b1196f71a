// Coarse-grained relative entropy of a measured law to an exact one, the paper's eq. kld:
//   D = sum over cells of p log(p/q),  p = counts/samples,  q = exact probability of the cell.
//
// With N samples drawn from q itself, 2 N D is close to chi-squared with (cells - 1) degrees of
// freedom, so D has the noise floor (cells - 1)/(2 N). Natural logarithms.
#ifndef BALLPISTON_CORE_STATISTICS_KL_DIVERGENCE_H_
#define BALLPISTON_CORE_STATISTICS_KL_DIVERGENCE_H_

#include <cstdint>
#include <span>

namespace ballpiston {

struct KlDivergence {
  double value = 0;
  double noise_floor = 0;
  int cells = 0;  // with a probability above 0

  // Of `value`, with the noncentral chi-squared law of 2 N D: its noncentrality is estimated by
  // 2 N (value - noise_floor), at least 0. What two runs may differ by, given their samples.
  double StandardError() const;
};

// One count for each probability; probabilities sum to 1. Requires at least one sample. A count
// where the probability is 0 makes the divergence infinite.
KlDivergence RelativeEntropy(std::span<const uint64_t> counts,
                             std::span<const double> probabilities);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_STATISTICS_KL_DIVERGENCE_H_
