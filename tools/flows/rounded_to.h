// A flow's number type, and its state in another number type. A flow computes one event after the
// other: EventFlow in any precision, or a naive flow with the same interface.
#pragma once

#include <type_traits>
#include <utility>

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

}  // namespace ballpiston
