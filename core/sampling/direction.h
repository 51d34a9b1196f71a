// Directions uniform on the unit circle, without trigonometric functions: a point uniform in the
// unit disc, scaled to length 1. Uses only +, *, / and sqrt, so the bits are the same on every
// machine.
#ifndef BALLPISTON_CORE_SAMPLING_DIRECTION_H_
#define BALLPISTON_CORE_SAMPLING_DIRECTION_H_

#include <Eigen/Core>

#include "core/sampling/counter_random.h"

namespace ballpiston {

Eigen::Vector2d UniformDirection(CounterRandom& random);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_SAMPLING_DIRECTION_H_
