#include "core/closed_form/circular_segment.h"

#include <cmath>

namespace ballpiston {

double AngleMinusSine(double angle) {
  // Above 1 the difference loses less than a factor of seven in accuracy. Below, the series
  //   x - sin x = x^3/6 (1 - x^2/(4 5) (1 - x^2/(6 7) (...)))
  // is cut at x^21/21!, 1e-18 of the leading term.
  if (angle > 1) return angle - std::sin(angle);
  const double x2 = angle * angle;
  double tail = 1;
  for (int k = 18; k >= 4; k -= 2) tail = 1 - x2 / (k * (k + 1)) * tail;
  return angle * x2 / 6 * tail;
}

double ChordAngle(double radius, double chord) { return 2 * std::asin(chord / (2 * radius)); }

double SegmentArea(double radius, double angle) {
  return radius * radius / 2 * AngleMinusSine(angle);
}

}  // namespace ballpiston
