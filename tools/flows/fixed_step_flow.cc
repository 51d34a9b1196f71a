#include "tools/flows/fixed_step_flow.h"

#include <cmath>
#include <utility>

namespace ballpiston {
namespace {

// A ball that is repaired this often in succession is pushed to and fro between two discs: a
// grazing one skips out of the disc after a few.
constexpr int kWedged = 1000;

}  // namespace

FixedStepFlow::FixedStepFlow(const PairGeometry& geometry, const PairState& state, double time_step)
    : time_step_(time_step),
      rho_(geometry.rho()),
      rho_squared_(geometry.rho() * geometry.rho()),
      piston_left_(geometry.piston_left()),
      piston_right_(geometry.piston_right()),
      position_(state.position),
      velocity_(state.ball_speed * state.direction),
      piston_(state.piston),
      piston_velocity_(state.piston_velocity) {}

FixedSteps FixedStepFlow::Advance(uint64_t most) {
  FixedSteps result;
  result.steps = MoveFreely(most);
  if (result.steps > 1) steps_inside_ = 0;
  result.ball_wall = RepairBall();
  result.piston_wall = RepairPiston();
  result.ball_piston = position_.x() > piston_ && velocity_.x() > piston_velocity_;
  result.lost = IsLost();
  return result;
}

// The disc in the ball's own quadrant is the nearest one. All in registers: this is the whole cost.
uint64_t FixedStepFlow::MoveFreely(uint64_t most) {
  double x = position_.x(), y = position_.y(), piston = piston_;
  const double dx = velocity_.x() * time_step_, dy = velocity_.y() * time_step_;
  const double dp = piston_velocity_ * time_step_;
  uint64_t steps = 0;
  bool wrong = false;
  do {
    x += dx;
    y += dy;
    piston += dp;
    const double to_x = 0.5 - std::fabs(x), to_y = 0.5 - std::fabs(y);
    wrong = (to_x * to_x + to_y * to_y < rho_squared_) | (x > piston) | (piston < piston_left_) |
            (piston > piston_right_);
  } while (++steps < most && !wrong);
  position_ = {x, y};
  piston_ = piston;
  return steps;
}

void FixedStepFlow::ExchangeComponents() {
  std::swap(velocity_.x(), piston_velocity_);
  position_.x() = piston_;
}

bool FixedStepFlow::RepairBall() {
  const Eigen::Vector2d centre(std::copysign(0.5, position_.x()),
                               std::copysign(0.5, position_.y()));
  const Eigen::Vector2d from_centre = position_ - centre;
  const double square = from_centre.squaredNorm();
  if (square >= rho_squared_) {
    steps_inside_ = 0;
    return false;
  }
  ++steps_inside_;
  const Eigen::Vector2d normal = from_centre / std::sqrt(square);
  position_ = centre + rho_ * normal;
  const double inward = velocity_.dot(normal);
  if (inward >= 0) return false;
  velocity_ -= 2 * inward * normal;
  return true;
}

bool FixedStepFlow::RepairPiston() {
  if (piston_ >= piston_left_ && piston_ <= piston_right_) return false;
  piston_ = 2 * (piston_ < piston_left_ ? piston_left_ : piston_right_) - piston_;
  piston_velocity_ = -piston_velocity_;
  return true;
}

bool FixedStepFlow::IsLost() const {
  const bool inside = std::fabs(position_.x()) <= 0.5 && std::fabs(position_.y()) <= 0.5;
  return !inside || steps_inside_ > kWedged;  // not a number is not inside
}

PairState FixedStepFlow::state() const {
  const double speed = velocity_.norm();
  PairState state = {.position = position_,
                     .ball_speed = speed,
                     .piston = piston_,
                     .piston_velocity = piston_velocity_};
  if (speed > 0) state.direction = velocity_ / speed;
  return state;
}

}  // namespace ballpiston
