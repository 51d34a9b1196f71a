// A state of the flow in another number type.
#pragma once

#include "core/geometry/pair_state.h"

namespace ballpiston {

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

}  // namespace ballpiston
