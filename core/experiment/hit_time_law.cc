#include "core/experiment/hit_time_law.h"

#include <cmath>

#include "core/experiment/without_last_bits.h"

namespace ballpiston {

Histogram EmptyHitTimes(double mean) {
  return Histogram::OfBins(0, WithoutLastBits(kHitTimeMeans * mean), kHitTimeBins);
}

std::vector<double> ExponentialBinProbabilities() {
  constexpr double kWidth = kHitTimeMeans / kHitTimeBins;
  const auto later_than = [](size_t bin) { return std::exp(-kWidth * static_cast<double>(bin)); };
  std::vector<double> probabilities(kHitTimeBins);
  for (size_t bin = 0; bin < kHitTimeBins; ++bin) {
    probabilities[bin] = later_than(bin) - later_than(bin + 1);
  }
  probabilities.back() = later_than(kHitTimeBins - 1);
  return probabilities;
}

}  // namespace ballpiston
