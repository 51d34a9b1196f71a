// The size of an error of the energy. An error that is not a number becomes infinite. Otherwise it
// would pass every limit: std::max drops NaN, and a comparison with NaN is false.
#pragma once

#include <cmath>
#include <limits>

namespace ballpiston::stability {

inline double ErrorSize(double error) {
  return std::isnan(error) ? std::numeric_limits<double>::infinity() : std::fabs(error);
}

}  // namespace ballpiston::stability
