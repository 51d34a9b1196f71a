// The Kolmogorov-Smirnov distance of a measured law to the uniform one: the largest difference
// between the two distribution functions, looked for at the edges of the histogram's bins.
//
// With N samples of the uniform law itself sqrt(N) D tends to the largest absolute value of a
// Brownian bridge, of mean sqrt(pi/2) log 2; looked at in only m + 1 points that misses
// 0.5826/sqrt(m), the constant -zeta(1/2)/sqrt(2 pi) of random walks. Property, with a test of its
// name:
//   1. NoiseFloorIsTheMeanDistanceOfUniformSamples.
#ifndef BALLPISTON_CORE_STATISTICS_KOLMOGOROV_SMIRNOV_H_
#define BALLPISTON_CORE_STATISTICS_KOLMOGOROV_SMIRNOV_H_

#include "core/statistics/histogram.h"

namespace ballpiston {

struct KolmogorovSmirnov {
  double distance = 0;
  double noise_floor = 0;     // the mean of `distance` for samples of the uniform law
  double standard_error = 0;  // of the measured distribution function where it is farthest off,
                              // for independent samples
};

// Of the law measured by `histogram` to the uniform one over all of its bins. Requires at least one
// sample.
KolmogorovSmirnov DistanceToUniform(const Histogram& histogram);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_STATISTICS_KOLMOGOROV_SMIRNOV_H_
