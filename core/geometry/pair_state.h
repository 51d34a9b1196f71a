// Where ball and piston are and how they move: a point of the flow's phase space.
//
// The ball's speed is a number of its own beside a unit direction, so that reflections cannot
// change it by rounding. Energies: eb = ball_speed^2/2, ep = piston_velocity^2/2, sum 1/2.
// PairState has doubles; other numbers are for flows in other precisions (billiard/event_flow.h).
#ifndef BALLPISTON_CORE_GEOMETRY_PAIR_STATE_H_
#define BALLPISTON_CORE_GEOMETRY_PAIR_STATE_H_

#include <Eigen/Core>

#include "core/geometry/pair_geometry.h"

namespace ballpiston {

template <typename Real>
struct PairStateOf {
  using Vector = Eigen::Matrix<Real, 2, 1>;

  Vector position = {0, 0};   // of the ball, (q1, q2)
  Vector direction = {1, 0};  // of the ball's flight, length 1; kept when at rest
  Real ball_speed = 0;
  Real piston = 0;  // q3
  Real piston_velocity = 0;
};

using PairState = PairStateOf<double>;

// The same state in other numbers, each rounded on its own.
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

// Of ball and piston together, by their speeds.
inline double EnergyOf(const PairState& state) {
  return (state.ball_speed * state.ball_speed + state.piston_velocity * state.piston_velocity) / 2;
}

// |2 E - 1|: how far the pair's energy, computed from all of the state, is from 1/2, relatively.
double EnergyError(const PairState& state);

// Whether a ball at `position` lies between the discs, up to `slack` inside of one.
bool InsideCell(const PairGeometry& geometry, const Eigen::Vector2d& position, double slack = 0);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_GEOMETRY_PAIR_STATE_H_
