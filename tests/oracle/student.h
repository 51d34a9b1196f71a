// Student's t.
#pragma once

#include <boost/math/distributions/students_t.hpp>

namespace ballpiston {

// The x with the probability of |t| <= x, for t with this many degrees of freedom.
inline double StudentQuantile(double freedom, double probability) {
  return boost::math::quantile(boost::math::students_t(freedom), (1 + probability) / 2);
}

}  // namespace ballpiston
