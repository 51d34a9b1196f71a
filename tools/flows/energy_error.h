// The relative error of the energy of a flow's state, in any number type.
#pragma once

#include <cmath>
#include <type_traits>

#include "core/billiard/lane_frame.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/rounded_to.h"

namespace ballpiston {

// 2 E - 1. For float and double it is computed in 64 bits, so that only the rounding of the state
// remains; else in the number's own precision.
template <typename Real>
double SignedEnergyError(const PairStateOf<Real>& s) {
  using Wide = std::conditional_t<std::is_floating_point_v<Real>, long double, Real>;
  const PairStateOf<Wide> w = RoundedTo<Wide>(s);
  const Wide ball = w.ball_speed * w.ball_speed * w.direction.squaredNorm();
  return static_cast<double>(Wide(ball + w.piston_velocity * w.piston_velocity - 1));
}

// The same for a ball alone in the lanes: |u|^2 - 1. h^2 + e^2 is near 1/2. Fused multiply-add
// keeps the rounding error small.
inline double SignedEnergyError(const LaneFrame& frame) {
  return 2 * std::fma(frame.h, frame.h, std::fma(frame.e, frame.e, -0.5));
}

}  // namespace ballpiston
