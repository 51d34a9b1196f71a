// The law of the time to the first ball-piston collision. In the limit delta -> 0 the law is
// expected to become exponential with the rate of eq. fmftbpeprate.
//
// Times are counted in kHitTimeBins bins, each a tenth of the mean return time at this energy;
// later hits count in the last bin. The result shows the law as the curve `survival`: the
// probability that ball and piston have not collided up to a time.
#pragma once

#include <cstddef>

#include "core/ensemble/point_summary.h"
#include "core/statistics/histogram.h"

namespace ballpiston {

inline constexpr size_t kHitTimeBins = 80;
inline constexpr double kHitTimeMeans = 8;  // upper end of the bins, in mean return times

// `mean`: the mean return time at this energy.
Histogram EmptyHitTimes(double mean);

// The points are at the lower edges of the bins. The errors are binomial; a point has one if
// enough earlier and later hits are expected in the limit.
Curve SurvivalCurve(const Histogram& hit_times);

}  // namespace ballpiston
