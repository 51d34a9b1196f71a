#include "core/experiment/hit_time_law.h"

#include <cmath>

#include "core/experiment/without_last_bits.h"
#include "core/statistics/told_error.h"

namespace ballpiston {

Histogram EmptyHitTimes(double mean) {
  return Histogram::OfBins(0, WithoutLastBits(kHitTimeMeans * mean), kHitTimeBins);
}

Curve SurvivalCurve(const Histogram& hit_times) {
  Curve curve = {.name = "survival"};
  const auto samples = static_cast<double>(hit_times.Total());
  if (samples == 0) return curve;
  double later = samples;
  for (size_t bin = 0; bin < kHitTimeBins; ++bin) {
    const double share = later / samples;
    const double limit = std::exp(-kHitTimeMeans / kHitTimeBins * static_cast<double>(bin));
    const double events = samples * limit * (1 - limit);
    const double error = std::sqrt(share * (1 - share) / samples);
    curve.points.push_back({.at = hit_times.Edge(bin),
                            .value = share,
                            .standard_error = bin == 0 ? 0 : ToldError(events, share, error),
                            .limit = limit});
    later -= static_cast<double>(hit_times.counts[bin]);
  }
  return curve;
}

}  // namespace ballpiston
