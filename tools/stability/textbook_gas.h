// A gas whose balls follow a textbook rule (textbook_ball.h). All bodies move from event to event;
// the next event is the earliest event of all bodies. For gases of a few cells.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/gas/reference_gas.h"
#include "core/gas/thermal_walls.h"
#include "tools/stability/textbook_ball.h"

namespace ballpiston::stability {

// The same interface as ReferenceGas, at the time of the last event.
template <TextbookRule rule>
class TextbookGas {
 public:
  TextbookGas(const GasGeometry& geometry, const GasState& start, ThermalWalls walls)
      : geometry_(geometry), walls_(std::move(walls)), pistons_(start.pistons) {
    for (const GasBall& ball : start.balls) {
      balls_.emplace_back(geometry.pair().rho(), ball.position, ball.direction * ball.speed);
    }
    FindNext();
  }

  double NextTime() const { return time_ + next_.time; }

  GasEvent Step() {
    const Next next = next_;
    time_ += next.time;
    for (Ball& ball : balls_) ball.Move(next.time);
    for (GasPiston& piston : pistons_) piston.offset += piston.velocity * next.time;
    GasEvent event = next.event;
    event.time = time_;
    if (event.kind == EventKind::kBallWall) balls_[Index(event.ball)].Reflect(next.disc);
    if (event.kind == EventKind::kBallPiston) Exchange(event);
    if (event.kind == EventKind::kPistonWall) Turn(event.piston);
    FindNext();
    return event;
  }

  GasBall BallAt(int64_t number, double /*time*/) const {
    const Ball& ball = balls_[Index(number)];
    const double speed = ball.velocity().norm();
    GasBall state = {.position = ball.position(), .speed = speed};
    if (speed > 0) state.direction = ball.velocity() / speed;
    return state;
  }
  GasPiston PistonAt(int64_t number, double /*time*/) const { return pistons_[Index(number)]; }

 private:
  using Ball = TextbookBall<rule>;

  struct Next {
    double time = Ball::kNever;  // from now
    int disc = Ball::kNone;
    GasEvent event = {};
  };

  static size_t Index(int64_t i) { return static_cast<size_t>(i); }

  void FindNext() {
    next_ = {};
    for (int64_t i = 0; i < geometry_.pistons(); ++i) LookAtPiston(i);
    for (int64_t i = 0; i < geometry_.balls(); ++i) LookAtBall(i);
  }

  void Offer(const Next& candidate) {
    if (candidate.time < next_.time) next_ = candidate;
  }

  void LookAtPiston(int64_t number) {
    const GasPiston& piston = pistons_[Index(number)];
    if (piston.velocity == 0) return;
    const double way = std::copysign(geometry_.reach(), piston.velocity) - piston.offset;
    Offer({.time = way / piston.velocity,
           .event = {.kind = EventKind::kPistonWall, .piston = number}});
  }

  void LookAtBall(int64_t number) {
    const Ball& ball = balls_[Index(number)];
    const auto [wall, disc] = ball.NextHit();
    if (disc != Ball::kNone) {
      Offer({.time = wall, .disc = disc, .event = {.kind = EventKind::kBallWall, .ball = number}});
    } else if (ball.velocity().squaredNorm() > 0) {
      Offer({.time = 0, .event = {.kind = EventKind::kEscape, .ball = number}});
    }
    for (int i = 0; i < geometry_.directions(); ++i) {
      const Direction direction = geometry_.DirectionAt(i);
      const int64_t piston = geometry_.PistonOf(number, direction);
      Offer({.time = TimeToMeet(ball, direction, pistons_[Index(piston)]),
             .event = {EventKind::kBallPiston, 0, number, piston, direction}});
    }
  }

  static double TimeToMeet(const Ball& ball, Direction direction, const GasPiston& piston) {
    const double sign = SignOf(direction);
    return Ball::TimeToMeet(0.5 + sign * piston.offset - SeenToward(direction, ball.position()).x(),
                            SeenToward(direction, ball.velocity()).x() - sign * piston.velocity);
  }

  void Exchange(const GasEvent& event) {
    Ball& ball = balls_[Index(event.ball)];
    GasPiston& piston = pistons_[Index(event.piston)];
    const double sign = SignOf(event.direction);
    Eigen::Vector2d velocity = SeenToward(event.direction, ball.velocity());
    const double piston_velocity = sign * piston.velocity;
    piston.velocity = sign * velocity.x();
    velocity.x() = piston_velocity;
    ball.SetVelocity(SeenFrom(event.direction, velocity));
  }

  void Turn(int64_t number) {
    GasPiston& piston = pistons_[Index(number)];
    const bool is_thermal = walls_.Has(number) && (piston.velocity < 0) == walls_.IsHot(number);
    const double speed = is_thermal ? walls_.DrawSpeed(number) : std::fabs(piston.velocity);
    piston.velocity = -std::copysign(speed, piston.velocity);
  }

  GasGeometry geometry_;
  ThermalWalls walls_;
  std::vector<Ball> balls_;
  std::vector<GasPiston> pistons_;
  double time_ = 0;
  Next next_;
};

}  // namespace ballpiston::stability
