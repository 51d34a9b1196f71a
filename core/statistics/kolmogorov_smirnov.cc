#include "core/statistics/kolmogorov_smirnov.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/statistics/group_scatter.h"

namespace ballpiston {
namespace {

constexpr double kMeanOfBridge = 0.86873116063615914;  // sqrt(pi/2) log 2
constexpr double kMissedBetweenPoints = 0.58259715793901067;
constexpr double kVarianceOfBridge = 0.067773203963865;  // pi^2/12 - pi/2 log^2 2

// The largest difference of equal laws is at any place, and scatters less than a difference at a
// fixed place. One in 200 samples of the uniform law has a distance above this many noise floors;
// beyond, the place becomes fixed.
constexpr double kFloorsOfNoise = 1.6;

// The interval of a normal law covers the mean of the bridge's maximum in 95.5 %, and in 95 % if
// its error has the uncertainty of the groups.
constexpr double kFreedomOfBridge = 1000;

// The variances of the distribution function at the inner edges of the groups' bins, relative to
// those of independent samples.
class ScatterOfFunction {
 public:
  explicit ScatterOfFunction(std::span<const Histogram> groups) {
    const std::vector<uint64_t> counts = CountsOf(groups);
    double samples = 0, below = 0, sum = 0, sum_expected = 0;
    for (const uint64_t count : counts) samples += static_cast<double>(count);
    const bool is_known = HaveSamples(groups);
    std::vector<double> weights(counts.size());
    for (size_t edge = 1; edge < counts.size(); ++edge) {
      below += static_cast<double>(counts[edge - 1]);
      for (size_t bin = 0; bin < counts.size(); ++bin)
        weights[bin] = (bin < edge) - below / samples;
      const double expected = below * (1 - below / samples);
      const double variance = is_known ? VarianceBetweenGroups(groups, weights) : expected;
      at_edges_.push_back(expected > 0 ? variance / expected : 1);
      sum += variance;
      sum_expected += expected;
    }
    mean_ = sum_expected > 0 ? sum / sum_expected : 1;
  }

  double Mean() const { return mean_; }
  // At the edge that is nearest to a place in [0, 1].
  double At(double place) const {
    const auto edge = static_cast<size_t>(place * static_cast<double>(at_edges_.size() + 1) + 0.5);
    return at_edges_[std::clamp<size_t>(edge, 1, at_edges_.size()) - 1];
  }

 private:
  std::vector<double> at_edges_;
  double mean_ = 1;
};

}  // namespace

KolmogorovSmirnov DistanceToUniform(const Histogram& histogram, std::span<const Histogram> groups) {
  const double samples = static_cast<double>(histogram.Total());
  const double bins = static_cast<double>(histogram.counts.size());
  KolmogorovSmirnov result;
  double at_the_place = 0;  // variance of the distribution function there, times samples
  double place = 0;
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
    place = static_cast<double>(bin + 1) / bins;
  }
  const ScatterOfFunction scatter(groups);
  result.noise_floor = (kMeanOfBridge - kMissedBetweenPoints / std::sqrt(bins)) *
                       std::sqrt(scatter.Mean() / samples);
  const double floors = result.distance / result.noise_floor;
  const double fixed = floors <= kFloorsOfNoise ? 0 : 1 - std::pow(kFloorsOfNoise / floors, 2);
  const double of_bridge = (1 - fixed) * kVarianceOfBridge * scatter.Mean();
  const double of_place = fixed * at_the_place * scatter.At(place);
  result.standard_error = std::sqrt((of_bridge + of_place) / samples);
  result.batches = 1 + static_cast<uint64_t>(std::lround(
                           FreedomOfSum(of_bridge, kFreedomOfBridge, of_place, kFreedomOfGroups)));
  return result;
}

}  // namespace ballpiston
