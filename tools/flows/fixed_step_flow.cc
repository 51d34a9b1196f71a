#include "tools/flows/fixed_step_flow.h"

#include <cmath>
#include <utility>

namespace ballpiston {

FixedStepFlow::FixedStepFlow(const PairGeometry& geometry, const PairState& state, double time_step)
    : time_step_(time_step),
      rho_squared_(geometry.rho() * geometry.rho()),
      piston_left_(geometry.piston_left()),
      piston_right_(geometry.piston_right()),
      ball_(geometry, state.position, state.ball_speed * state.direction),
      piston_(state.piston),
      piston_velocity_(state.piston_velocity) {}

Event FixedStepFlow::Step() {
  constexpr uint64_t kMostSteps = 1'000'000'000;
  uint64_t steps = 0;
  while (pending_.empty() && steps < kMostSteps) steps += Advance();
  Event event = {EventKind::kEscape, time_step_ * static_cast<double>(steps)};
  if (!pending_.empty()) {
    event.kind = pending_.back();
    pending_.pop_back();
  }
  return event;
}

// Makes steps until a repair is needed, but at most 1024 steps; returns their number.
uint64_t FixedStepFlow::Advance() {
  const uint64_t steps = MoveFreely();
  if (steps > 1) ball_.MovedFreely();
  const bool ball_wall = ball_.Repair(), piston_wall = RepairPiston();
  const bool meet = ball_.position.x() > piston_ && ball_.velocity.x() > piston_velocity_;
  if (meet) pending_.push_back(EventKind::kBallPiston);
  if (piston_wall) pending_.push_back(EventKind::kPistonWall);
  if (ball_wall) pending_.push_back(EventKind::kBallWall);
  if (ball_.IsLost()) pending_.push_back(EventKind::kEscape);
  return steps;
}

// The disc in the ball's quadrant is the nearest disc. This loop is the whole cost of the flow:
// everything is in registers.
uint64_t FixedStepFlow::MoveFreely() {
  constexpr uint64_t kMost = 1024;  // so that Advance soon finds a ball that has left the cell
  double x = ball_.position.x(), y = ball_.position.y(), piston = piston_;
  const double dx = ball_.velocity.x() * time_step_, dy = ball_.velocity.y() * time_step_;
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
  } while (++steps < kMost && !wrong);
  ball_.position = {x, y};
  piston_ = piston;
  return steps;
}

void FixedStepFlow::ExchangeComponents() {
  std::swap(ball_.velocity.x(), piston_velocity_);
  ball_.position.x() = piston_;
}

bool FixedStepFlow::RepairPiston() {
  if (piston_ >= piston_left_ && piston_ <= piston_right_) return false;
  piston_ = 2 * (piston_ < piston_left_ ? piston_left_ : piston_right_) - piston_;
  piston_velocity_ = -piston_velocity_;
  return true;
}

}  // namespace ballpiston
