#include "core/geometry/pair_state.h"

#include <cmath>

namespace ballpiston {

PairState WithVelocities(const Eigen::Vector2d& position, const Eigen::Vector2d& velocity,
                         double piston, double piston_velocity) {
  const double speed = velocity.norm();
  PairState state = {.position = position,
                     .ball_speed = speed,
                     .piston = piston,
                     .piston_velocity = piston_velocity};
  if (speed > 0) state.direction = velocity / speed;
  return state;
}

double EnergyError(const PairState& state) {
  const double ball = state.ball_speed * state.ball_speed * state.direction.squaredNorm();
  return std::fabs(ball + state.piston_velocity * state.piston_velocity - 1);
}

bool InsideCell(const PairGeometry& geometry, const Eigen::Vector2d& position, double slack) {
  // The nearest disc is the one in the ball's quadrant.
  const double dx = 0.5 - std::fabs(position.x()), dy = 0.5 - std::fabs(position.y());
  return dx >= 0 && dy >= 0 && std::sqrt(dx * dx + dy * dy) >= geometry.rho() - slack;
}

}  // namespace ballpiston
