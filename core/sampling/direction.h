// Directions uniform on the unit circle, without trigonometric functions: a point uniform in the
// unit disc, scaled to length 1. Uses only +, *, / and sqrt, so the bits are the same on every
// machine.
#pragma once

#include <Eigen/Core>

#include "core/sampling/counter_random.h"

namespace ballpiston {

Eigen::Vector2d UniformDirection(CounterRandom& random);

}  // namespace ballpiston
