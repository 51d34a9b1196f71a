// The circular segment, the part of a disc that a chord cuts off, has the area
// r^2 (angle - sin angle)/2. The printed closed forms contain this difference as a trapezium minus
// a sector, which loses all digits on short arcs. The function here computes it directly.
//
// Domain: 0 <= angle <= 2 pi.
//
// The relative error is below 2e-15, unless angle^3 underflows.
//
// A pure function: safe from any thread.
#pragma once

#include <cmath>

namespace ballpiston {

// angle - sin(angle).
inline double AngleMinusSine(double angle) {
  // Above 1 the difference loses less than a factor of seven in accuracy. Below, the series
  //   x - sin x = x^3/6 (1 - x^2/(4 5) (1 - x^2/(6 7) (...)))
  // is cut at x^21/21!, 1e-18 of the leading term.
  if (angle > 1) return angle - std::sin(angle);
  const double x2 = angle * angle;
  double tail = 1;
  for (int k = 18; k >= 4; k -= 2) tail = 1 - x2 / (k * (k + 1)) * tail;
  return angle * x2 / 6 * tail;
}

}  // namespace ballpiston
