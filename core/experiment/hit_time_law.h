// Bins of the time to the first ball-piston collision, and the exponential law beside them.
//
// The bins reach up to kHitTimeMeans mean return times; later hits count in the last bin. The law
// of hit times is expected to become exponential as delta -> 0, with the rate of eq. fmftbpeprate.
#ifndef BALLPISTON_CORE_EXPERIMENT_HIT_TIME_LAW_H_
#define BALLPISTON_CORE_EXPERIMENT_HIT_TIME_LAW_H_

#include <cstddef>
#include <vector>

#include "core/statistics/histogram.h"

namespace ballpiston {

inline constexpr size_t kHitTimeBins = 160;
inline constexpr double kHitTimeMeans = 8;

// `mean`: the mean return time at this energy.
Histogram EmptyHitTimes(double mean);

// Of an exponential law with this mean. The last bin has all times above its lower edge.
std::vector<double> ExponentialBinProbabilities();

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_HIT_TIME_LAW_H_
