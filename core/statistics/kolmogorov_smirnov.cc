#include "core/statistics/kolmogorov_smirnov.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace ballpiston {
namespace {

constexpr double kMeanOfBridge = 0.86873116063615914;  // sqrt(pi/2) log 2
constexpr double kMissedBetweenPoints = 0.58259715793901067;
constexpr double kVarianceOfBridge = 0.067773203963865;  // pi^2/12 - pi/2 log^2 2

// The largest difference of equal laws is at any place, and scatters less than a difference at a
// fixed place. One in 200 samples of the uniform law has a distance above this many noise floors;
// beyond, the place becomes fixed.
constexpr double kFloorsOfNoise = 1.6;

}  // namespace

KolmogorovSmirnov DistanceToUniform(const Histogram& histogram) {
  const double samples = static_cast<double>(histogram.Total());
  const double bins = static_cast<double>(histogram.counts.size());
  KolmogorovSmirnov result;
  double at_the_place = 0;  // variance of the distribution function there, times samples
  uint64_t below = 0;
  for (size_t bin = 0; bin < histogram.counts.size(); ++bin) {
    below += histogram.counts[bin];
    const double measured = static_cast<double>(below) / samples;
    const double distance = std::fabs(measured - static_cast<double>(bin + 1) / bins);
    if (distance <= result.distance) continue;
    result.distance = distance;
    // Half a sample is added on either side, so that the error is never 0.
    const double share = (static_cast<double>(below) + 0.5) / (samples + 1);
    at_the_place = share * (1 - share);
  }
  result.noise_floor =
      (kMeanOfBridge - kMissedBetweenPoints / std::sqrt(bins)) / std::sqrt(samples);
  const double floors = result.distance / result.noise_floor;
  const double fixed = floors <= kFloorsOfNoise ? 0 : 1 - std::pow(kFloorsOfNoise / floors, 2);
  const double variance = kVarianceOfBridge + fixed * (at_the_place - kVarianceOfBridge);
  result.standard_error = std::sqrt(variance / samples);
  return result;
}

}  // namespace ballpiston
