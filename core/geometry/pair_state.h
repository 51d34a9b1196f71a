// Positions and velocities of ball and piston: a point of the flow's phase space.
//
// The ball's velocity is stored as a speed and a unit direction, so that rounding in reflections
// cannot change the speed. Energies: eb = ball_speed^2/2, ep = piston_velocity^2/2, sum 1/2.
// PairState uses doubles. Other number types are for flows in other precisions
// (billiard/event_flow.h).
#pragma once

#include <Eigen/Core>

#include "core/geometry/pair_geometry.h"

namespace ballpiston {

template <typename Real>
struct PairStateOf {
  using Vector = Eigen::Matrix<Real, 2, 1>;

  Vector position = {0, 0};   // of the ball, (q1, q2)
  Vector direction = {1, 0};  // of the ball's velocity, length 1; kept when the ball is at rest
  Real ball_speed = 0;
  Real piston = 0;  // q3
  Real piston_velocity = 0;
};

using PairState = PairStateOf<double>;

// The state with these velocities. The direction of a ball at rest is (1, 0).
PairState WithVelocities(const Eigen::Vector2d& position, const Eigen::Vector2d& velocity,
                         double piston, double piston_velocity);

// The energy of ball and piston together, from their speeds.
inline double EnergyOf(const PairState& state) {
  return (state.ball_speed * state.ball_speed + state.piston_velocity * state.piston_velocity) / 2;
}

// |2 E - 1|, the relative deviation of the pair's energy E from 1/2. E is computed from the whole
// state, including the length of `direction`.
double EnergyError(const PairState& state);

// Whether a ball at `position` lies between the discs. It may be inside a disc by up to `slack`.
bool InsideCell(const PairGeometry& geometry, const Eigen::Vector2d& position, double slack = 0);

}  // namespace ballpiston
