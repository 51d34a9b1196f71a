#include "core/statistics/kolmogorov_smirnov.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace ballpiston {
namespace {

constexpr double kMeanOfBridge = 0.86873116063615914;  // sqrt(pi/2) log 2
constexpr double kMissedBetweenPoints = 0.58259715793901067;

}  // namespace

KolmogorovSmirnov DistanceToUniform(const Histogram& histogram) {
  const double samples = static_cast<double>(histogram.Total());
  const double bins = static_cast<double>(histogram.counts.size());
  KolmogorovSmirnov result;
  uint64_t below = 0;
  for (size_t bin = 0; bin < histogram.counts.size(); ++bin) {
    below += histogram.counts[bin];
    const double measured = static_cast<double>(below) / samples;
    const double distance = std::fabs(measured - static_cast<double>(bin + 1) / bins);
    if (distance <= result.distance) continue;
    result.distance = distance;
    // Half a sample is added on either side, so that the error is never 0.
    const double share = (static_cast<double>(below) + 0.5) / (samples + 1);
    result.standard_error = std::sqrt(share * (1 - share) / samples);
  }
  result.noise_floor =
      (kMeanOfBridge - kMissedBetweenPoints / std::sqrt(bins)) / std::sqrt(samples);
  return result;
}

}  // namespace ballpiston
