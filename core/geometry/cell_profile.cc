#include "core/geometry/cell_profile.h"

#include <algorithm>
#include <cmath>

namespace ballpiston {

double CentreToArc(double lambda, double depth) {
  // 4 s^2 = 1 - 4 t (t + lambda). The factor 1 - 2 t is exact for t > 1/4. This matters for
  // t -> 1/2 and lambda -> 0, where s tends to lambda/2.
  const double square = (1 - 2 * depth) * (1 + 2 * depth) - 4 * depth * lambda;
  return std::sqrt(std::max(square, 0.0)) / 2;
}

double HalfHeight(double lambda, double depth) {
  return depth * (depth + lambda) / (0.5 + CentreToArc(lambda, depth));
}

}  // namespace ballpiston
