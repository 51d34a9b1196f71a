// Directions uniform on the unit circle, without trigonometric functions: a point uniform in the
// unit disc, scaled to length 1. Uses only +, *, / and sqrt, so the bits are the same on every
// machine.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/sampling/counter_random.h"

namespace ballpiston {

inline Eigen::Vector2d UniformDirection(CounterRandom& random) {
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
