// The Kolmogorov-Smirnov distance D of a measured law from the uniform law: the largest difference
// between the two distribution functions at the edges of the histogram's bins.
//
// For N samples of the uniform law, sqrt(N) D tends to the maximum of the absolute value of a
// Brownian bridge, with the mean sqrt(pi/2) log 2 and the variance pi^2/12 - pi/2 log^2 2. The
// maximum over only m + 1 points is smaller by 0.5826/sqrt(m); the constant is -zeta(1/2)/sqrt(2
// pi), as for random walks. Properties, each with a test of its name:
//   1. NoiseFloorIsTheMeanDistanceOfUniformSamples.
//   2. ErrorsHoldForCorrelatedSamples.
#pragma once

#include <cstdint>
#include <span>

#include "core/statistics/histogram.h"

namespace ballpiston {

struct KolmogorovSmirnov {
  double distance = 0;
  double noise_floor = 0;     // the mean of `distance` for samples of the uniform law
  double standard_error = 0;  // for equal laws the scatter of `distance`, far from them that of
                              // the distribution function at the largest difference
  uint64_t batches = 0;       // of standard_error, as in Estimate
};

// The distance of the law measured by `histogram` from the uniform law over all of its bins.
// Requires at least one sample. `groups` counts the same samples in fewer bins, by group
// (group_scatter.h), because samples within a group may be correlated. While a group is empty the
// noise is that of independent samples.
KolmogorovSmirnov DistanceToUniform(const Histogram& histogram, std::span<const Histogram> groups);

}  // namespace ballpiston
