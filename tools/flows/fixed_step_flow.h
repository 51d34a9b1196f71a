// The naive method for ball and piston: a fixed time step, and a repair of each overlap. Programs
// that integrate forces work in this way. It is the baseline for the event-driven flows.
//
// Each step moves both along straight lines. Then
//   - a ball inside a disc is pushed out along the normal, and its velocity is reflected if it
//     heads inward;
//   - a piston beyond its wall is folded back, which is exact;
//   - a ball that has passed the piston collides with it, up to a step too late.
// On average a hit is half a step late. Therefore times have a bias of first order in the step,
// larger than the step divided by the mean flight. Contacts shorter than a step are missed.
// Properties, each with a test of its name:
//   1. EnergyStaysExact, to rounding.  2. TimeIsBiasedToFirstOrderInTheStep.
//   3. OnlyReflectionsAndCollisionsAreEvents: pushing out a ball that already leaves the disc is no
//      event; nor is a ball beyond the piston that already comes back.
//
// One object is one orbit; not for sharing between threads.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

// The ball. After a step in which it has entered a disc, it is repaired.
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

// The same interface as ReferenceFlow.
class FixedStepFlow {
 public:
  // time_step > 0.
  FixedStepFlow(const PairGeometry& geometry, const PairState& state, double time_step = 1e-3);

  // Makes steps until there is an event. Only the first event of a step has a duration above 0.
  // kEscape: the ball left the unit cell, is wedged between discs, or has no event in 1e9 steps.
  Event Step();
  void ExchangeComponents();

  PairState state() const {
    return WithVelocities(ball_.position, ball_.velocity, piston_, piston_velocity_);
  }

 private:
  uint64_t Advance();
  uint64_t MoveFreely();
  bool RepairPiston();

  double time_step_;
  double rho_squared_;
  double piston_left_;
  double piston_right_;

  FixedStepBall ball_;
  double piston_;
  double piston_velocity_;
  std::vector<EventKind> pending_;  // the events of the last step; the next one is at the end
};

}  // namespace ballpiston
