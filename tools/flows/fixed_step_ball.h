// A ball that moves by fixed time steps. After a step in which it has entered a disc, it is pushed
// out along the normal, and its velocity is reflected if it heads inward.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/geometry/pair_geometry.h"

namespace ballpiston {

class FixedStepBall {
 public:
  FixedStepBall(const PairGeometry& geometry, const Eigen::Vector2d& position,
                const Eigen::Vector2d& velocity)
      : position(position), velocity(velocity), rho_(geometry.rho()) {}

  // True if the velocity was reflected.
  bool Repair() {
    const Eigen::Vector2d centre(std::copysign(0.5, position.x()),
                                 std::copysign(0.5, position.y()));
    const Eigen::Vector2d from_centre = position - centre;
    const double square = from_centre.squaredNorm();
    if (square >= rho_ * rho_) {
      steps_inside_ = 0;
      return false;
    }
    ++steps_inside_;
    const Eigen::Vector2d normal = from_centre / std::sqrt(square);
    position = centre + rho_ * normal;
    const double inward = velocity.dot(normal);
    if (inward >= 0) return false;
    velocity -= 2 * inward * normal;
    return true;
  }

  // To be called after steps outside all discs.
  void MovedFreely() { steps_inside_ = 0; }

  // The ball has left the unit cell, or is wedged between two discs.
  bool IsLost() const {
    const bool inside = std::fabs(position.x()) <= 0.5 && std::fabs(position.y()) <= 0.5;
    return !inside || steps_inside_ > kWedged;  // not a number is not inside
  }

  Eigen::Vector2d position;
  Eigen::Vector2d velocity;

 private:
  // After so many repairs in succession a ball is wedged: two discs push it to and fro. A grazing
  // ball leaves the disc after a few repairs.
  static constexpr int kWedged = 1000;

  double rho_;
  int steps_inside_ = 0;  // successive steps inside a disc
};

}  // namespace ballpiston
