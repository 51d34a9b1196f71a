#include "tools/flows/fixed_step_gas.h"

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <utility>

namespace ballpiston {

FixedStepGas::FixedStepGas(const GasGeometry& geometry, const GasState& start, ThermalWalls walls,
                           double time_step)
    : geometry_(geometry),
      walls_(std::move(walls)),
      time_step_(time_step),
      pistons_(start.pistons) {
  for (const GasBall& ball : start.balls) {
    balls_.push_back({FixedStepBall(geometry.pair(), ball.position, ball.speed * ball.direction)});
  }
}

double FixedStepGas::NextTime() {
  constexpr double kLongTime = 1000;
  const double end = Now() + kLongTime;
  while (told_ == events_.size() && Now() < end) Advance();
  return told_ == events_.size() ? std::numeric_limits<double>::infinity() : events_[told_].time;
}

GasEvent FixedStepGas::Step() {
  NextTime();
  return events_[told_++];
}

void FixedStepGas::Advance() {
  events_.clear();
  told_ = 0;
  ++steps_;
  for (int64_t piston = 0; piston < geometry_.pistons(); ++piston) MovePiston(piston);
  for (int64_t ball = 0; ball < geometry_.balls(); ++ball) MoveBall(ball);
}

void FixedStepGas::MovePiston(int64_t number) {
  GasPiston& piston = pistons_[static_cast<size_t>(number)];
  piston.offset += piston.velocity * time_step_;
  if (std::fabs(piston.offset) <= geometry_.reach()) return;
  const bool is_thermal = walls_.Has(number) && (piston.offset < 0) == walls_.IsHot(number);
  piston.offset = std::copysign(2 * geometry_.reach(), piston.offset) - piston.offset;
  const double speed = is_thermal ? walls_.DrawSpeed(number) : std::fabs(piston.velocity);
  piston.velocity = -std::copysign(speed, piston.velocity);
  events_.push_back({.kind = EventKind::kPistonWall,
                     .time = Now(),
                     .piston = number,
                     .piston_energy = EnergyOf(piston)});
}

void FixedStepGas::MoveBall(int64_t number) {
  Ball& ball = balls_[static_cast<size_t>(number)];
  if (ball.is_lost) return;
  ball.moving.position += ball.moving.velocity * time_step_;
  if (ball.moving.Repair()) {
    events_.push_back({.kind = EventKind::kBallWall, .time = Now(), .ball = number});
  }
  for (int i = 0; i < geometry_.directions(); ++i) Collide(number, geometry_.DirectionAt(i));
  ball.is_lost = ball.moving.IsLost();
  if (ball.is_lost) {
    events_.push_back({.kind = EventKind::kEscape, .time = Now(), .ball = number});
  }
}

// Exchanges energy if the ball has passed the piston and they still approach.
void FixedStepGas::Collide(int64_t number, Direction direction) {
  FixedStepBall& ball = balls_[static_cast<size_t>(number)].moving;
  const int64_t piston_number = geometry_.PistonOf(number, direction);
  GasPiston& piston = pistons_[static_cast<size_t>(piston_number)];
  const double sign = SignOf(direction), place = 0.5 + sign * piston.offset;
  Eigen::Vector2d position = SeenToward(direction, ball.position);
  Eigen::Vector2d velocity = SeenToward(direction, ball.velocity);
  if (position.x() <= place || velocity.x() <= sign * piston.velocity) return;
  const double piston_velocity = sign * piston.velocity;
  piston.velocity = sign * velocity.x();
  velocity.x() = piston_velocity;
  position.x() = place;
  ball.position = SeenFrom(direction, position);
  ball.velocity = SeenFrom(direction, velocity);
  events_.push_back({EventKind::kBallPiston, Now(), number, piston_number, direction,
                     EnergyOf(BallAt(number, Now())), EnergyOf(piston)});
}

GasBall FixedStepGas::BallAt(int64_t number, double /*time*/) const {
  const FixedStepBall& ball = balls_[static_cast<size_t>(number)].moving;
  const double speed = ball.velocity.norm();
  GasBall state = {.position = ball.position, .speed = speed};
  if (speed > 0) state.direction = ball.velocity / speed;
  return state;
}

}  // namespace ballpiston
