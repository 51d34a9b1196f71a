// A flow's number type, its state in another number type, and the error of its energy. A flow
// computes one event after the other: EventFlow in any precision, or a naive flow with the same
// interface.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "core/billiard/lane_frame.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

template <typename Flow>
using RealOf = std::remove_cvref_t<decltype(std::declval<Flow>().state().ball_speed)>;

// Each number is rounded separately.
template <typename To, typename From>
PairStateOf<To> RoundedTo(const PairStateOf<From>& state) {
  const auto vector = [](const auto& v) -> typename PairStateOf<To>::Vector {
    return {static_cast<To>(v.x()), static_cast<To>(v.y())};
  };
  return {.position = vector(state.position),
          .direction = vector(state.direction),
          .ball_speed = static_cast<To>(state.ball_speed),
          .piston = static_cast<To>(state.piston),
          .piston_velocity = static_cast<To>(state.piston_velocity)};
}

// At least the epsilon of a double: the checks themselves are computed in double.
template <typename Flow>
inline constexpr double kEpsilonOf = std::is_same_v<RealOf<Flow>, float>
                                         ? std::numeric_limits<float>::epsilon()
                                         : std::numeric_limits<double>::epsilon();

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
