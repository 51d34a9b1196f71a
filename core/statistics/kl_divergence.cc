#include "core/statistics/kl_divergence.h"

#include <cmath>
#include <cstddef>
#include <numeric>

namespace ballpiston {

double KlDivergence::StandardError() const {
  const double freedom = cells - 1;
  if (freedom <= 0) return 0;
  const double twice_samples = freedom / noise_floor;
  const double noncentrality = twice_samples * std::fmax(value - noise_floor, 0);
  return std::sqrt(2 * (freedom + 2 * noncentrality)) / twice_samples;
}

KlDivergence RelativeEntropy(std::span<const uint64_t> counts,
                             std::span<const double> probabilities) {
  const double samples =
      static_cast<double>(std::accumulate(counts.begin(), counts.end(), uint64_t{0}));
  KlDivergence result;
  for (size_t i = 0; i < counts.size(); ++i) {
    if (probabilities[i] > 0) ++result.cells;
    if (counts[i] == 0) continue;
    const double p = static_cast<double>(counts[i]) / samples;
    result.value += p * std::log(p / probabilities[i]);
  }
  result.noise_floor = (result.cells - 1) / (2 * samples);
  return result;
}

}  // namespace ballpiston
