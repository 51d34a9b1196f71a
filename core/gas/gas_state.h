// The positions and velocities of all balls and pistons of a gas: a point of its phase space.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace ballpiston {

struct GasBall {
  Eigen::Vector2d position = {0, 0};   // from the centre of its cell
  Eigen::Vector2d direction = {1, 0};  // of its velocity, length 1; kept when the ball is at rest
  double speed = 0;
};

struct GasPiston {
  double offset = 0;  // from its edge, toward +x or +y
  double velocity = 0;
};

struct GasState {
  std::vector<GasBall> balls;
  std::vector<GasPiston> pistons;
};

inline double EnergyOf(const GasBall& ball) { return ball.speed * ball.speed / 2; }
inline double EnergyOf(const GasPiston& piston) { return piston.velocity * piston.velocity / 2; }
inline double EnergyOf(const GasState& state) {
  double sum = 0;
  for (const GasBall& ball : state.balls) sum += EnergyOf(ball);
  for (const GasPiston& piston : state.pistons) sum += EnergyOf(piston);
  return sum;
}

}  // namespace ballpiston
