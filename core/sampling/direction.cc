#include "core/sampling/direction.h"

#include <cmath>

namespace ballpiston {

Eigen::Vector2d UniformDirection(CounterRandom& random) {
  for (;;) {
    const double x = 2 * random.Uniform() - 1;
    const double y = 2 * random.Uniform() - 1;
    const double square = x * x + y * y;
    if (square > 1 || square == 0) continue;
    const double length = std::sqrt(square);
    return {x / length, y / length};
  }
}

}  // namespace ballpiston
