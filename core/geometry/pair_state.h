// Where ball and piston are and how they move: a point of the flow's phase space.
//
// The ball's speed is a number of its own beside a unit direction, so that reflections cannot
// change it by rounding. Energies: eb = ball_speed^2/2, ep = piston_velocity^2/2, sum 1/2.
#ifndef BALLPISTON_CORE_GEOMETRY_PAIR_STATE_H_
#define BALLPISTON_CORE_GEOMETRY_PAIR_STATE_H_

#include <Eigen/Core>

#include "core/geometry/pair_geometry.h"

namespace ballpiston {

struct PairState {
  Eigen::Vector2d position = {0, 0};   // of the ball, (q1, q2)
  Eigen::Vector2d direction = {1, 0};  // of the ball's flight, length 1; kept when at rest
  double ball_speed = 0;
  double piston = 0;  // q3
  double piston_velocity = 0;
};

// |2 E - 1|: how far the pair's energy, computed from all of the state, is from 1/2, relatively.
double EnergyError(const PairState& state);

// Whether a ball at `position` lies between the discs, up to `slack` inside of one.
bool InsideCell(const PairGeometry& geometry, const Eigen::Vector2d& position, double slack = 0);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_GEOMETRY_PAIR_STATE_H_
