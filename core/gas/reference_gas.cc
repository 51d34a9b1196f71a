#include "core/gas/reference_gas.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/billiard/exchange.h"

namespace ballpiston {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

}  // namespace

ReferenceGas::ReferenceGas(const GasGeometry& geometry, const GasState& state, ThermalWalls walls)
    : geometry_(geometry),
      cell_walls_(geometry.pair()),
      thermal_walls_(std::move(walls)),
      balls_(state.balls.size()),
      pistons_(state.pistons.size()),
      queue_(balls_.size() + pistons_.size()) {
  for (size_t i = 0; i < pistons_.size(); ++i) {
    pistons_[i].state = state.pistons[i];
    TimePiston(pistons_[i]);
    SchedulePiston(static_cast<int64_t>(i));
  }
  for (size_t i = 0; i < balls_.size(); ++i) {
    balls_[i].state = state.balls[i];
    Aim(balls_[i]);
    LookAgain(static_cast<int64_t>(i));
  }
}

GasEvent ReferenceGas::Step() {
  const size_t body = queue_.First().body;
  if (body >= balls_.size()) return TurnPiston(static_cast<int64_t>(body - balls_.size()));
  const Ball& ball = balls_[body];
  const auto number = static_cast<int64_t>(body);
  return ball.contact_time <= ball.wall_time ? Exchange(number) : HitWall(number);
}

GasEvent ReferenceGas::HitWall(int64_t number) {
  Ball& ball = balls_[Index(number)];
  const GasEvent event = {.kind = EventKind::kBallWall, .time = ball.wall_time, .ball = number};
  if (ball.encounter.disc == kNoDisc) {
    ball.wall_time = ball.contact_time = kNever;
    Schedule(number);
    return {.kind = EventKind::kEscape, .time = event.time, .ball = number};
  }
  cell_walls_.Reflect(ball.encounter, ball.state.position, ball.state.direction);
  ball.last_disc = ball.encounter.disc;
  ball.time = event.time;
  Aim(ball);
  LookAgain(number);
  return event;
}

GasEvent ReferenceGas::TurnPiston(int64_t number) {
  Piston& piston = pistons_[Index(number)];
  const GasEvent event = {
      .kind = EventKind::kPistonWall, .time = piston.turn_time, .piston = number};
  GasPiston& state = piston.state;
  piston.time = event.time;
  state.offset = std::copysign(geometry_.reach(), state.velocity);
  const bool is_thermal =
      thermal_walls_.Has(number) && (state.velocity < 0) == thermal_walls_.IsHot(number);
  const double speed = is_thermal ? thermal_walls_.DrawSpeed(number) : std::fabs(state.velocity);
  state.velocity = -std::copysign(speed, state.velocity);
  TimePiston(piston);
  SchedulePiston(number);
  const Direction direction = geometry_.DirectionTo(number);
  for (const Direction side : {direction, Opposite(direction)}) {
    const int64_t ball = geometry_.BallOf(number, side);
    if (ball != GasGeometry::kNoBall) LookAgain(ball);
  }
  return event;
}

// The pair's exchange, in the cell turned until the piston is on the right.
GasEvent ReferenceGas::Exchange(int64_t number) {
  Ball& ball = balls_[Index(number)];
  const Direction direction = ball.contact;
  const double time = ball.contact_time, sign = SignOf(direction);
  const int64_t piston_number = geometry_.PistonOf(number, direction);
  Piston& piston = pistons_[Index(piston_number)];
  const GasBall ball_there = BallAt(number, time);
  const double offset = PistonAt(piston_number, time).offset;
  const PairState before = {.position = SeenToward(direction, ball_there.position),
                            .direction = SeenToward(direction, ball_there.direction),
                            .ball_speed = ball_there.speed,
                            .piston = 0.5 + sign * offset,
                            .piston_velocity = sign * piston.state.velocity};
  const PairState after = AfterExchange(before, std::sqrt(2 * EnergyOf(before)));
  ball.state = {.position = SeenFrom(direction, after.position),
                .direction = SeenFrom(direction, after.direction),
                .speed = after.ball_speed};
  piston.state = {.offset = offset, .velocity = sign * after.piston_velocity};
  ball.time = piston.time = time;
  ball.last_disc = kNoDisc;
  Aim(ball);
  TimePiston(piston);
  SchedulePiston(piston_number);
  LookAgain(number);
  const int64_t other = geometry_.BallOf(piston_number, Opposite(direction));
  if (other != GasGeometry::kNoBall && other != number) LookAgain(other);
  return {EventKind::kBallPiston, time, number, piston_number, direction};
}

void ReferenceGas::Aim(Ball& ball) const {
  ball.encounter = cell_walls_.Next(ball.state.position, ball.state.direction, ball.last_disc);
  if (ball.state.speed == 0) {
    ball.wall_time = kNever;
  } else if (ball.encounter.disc == kNoDisc) {
    ball.wall_time = ball.time;
  } else {
    ball.wall_time = ball.time + ball.encounter.distance / ball.state.speed;
  }
}

void ReferenceGas::TimePiston(Piston& piston) const {
  const double velocity = piston.state.velocity;
  const double way = std::copysign(geometry_.reach(), velocity) - piston.state.offset;
  piston.turn_time = velocity == 0 ? kNever : piston.time + std::max(way / velocity, 0.0);
}

void ReferenceGas::LookAgain(int64_t number) {
  Ball& ball = balls_[Index(number)];
  ball.contact_time = kNever;
  for (int i = 0; i < geometry_.directions(); ++i) {
    const Direction direction = geometry_.DirectionAt(i);
    const Piston& piston = pistons_[Index(geometry_.PistonOf(number, direction))];
    const double time = ContactTime(ball, direction, piston);
    if (time >= ball.contact_time) continue;
    ball.contact_time = time;
    ball.contact = direction;
  }
  Schedule(number);
}

// The time of a contact before ball or piston hits a wall. A contact at the moment when the piston
// turns counts, because the piston may never come nearer to a ball at rest.
double ReferenceGas::ContactTime(const Ball& ball, Direction direction,
                                 const Piston& piston) const {
  const double sign = SignOf(direction), now = std::max(ball.time, piston.time);
  const double ball_velocity = ball.state.speed * SeenToward(direction, ball.state.direction).x();
  const double approach = ball_velocity - sign * piston.state.velocity;
  if (approach <= 0) return kNever;
  const double ball_x =
      SeenToward(direction, ball.state.position).x() + ball_velocity * (now - ball.time);
  const double piston_x =
      0.5 + sign * (piston.state.offset + piston.state.velocity * (now - piston.time));
  const double time = now + std::max(piston_x - ball_x, 0.0) / approach;
  return time <= std::min(ball.wall_time, piston.turn_time) ? time : kNever;
}

void ReferenceGas::Schedule(int64_t number) {
  const Ball& ball = balls_[Index(number)];
  queue_.Set(Index(number), std::min(ball.wall_time, ball.contact_time));
}

void ReferenceGas::SchedulePiston(int64_t number) {
  queue_.Set(balls_.size() + Index(number), pistons_[Index(number)].turn_time);
}

GasBall ReferenceGas::BallAt(int64_t number, double time) const {
  const Ball& ball = balls_[Index(number)];
  GasBall state = ball.state;
  state.position += state.direction * (state.speed * (time - ball.time));
  return state;
}

GasPiston ReferenceGas::PistonAt(int64_t number, double time) const {
  const Piston& piston = pistons_[Index(number)];
  GasPiston state = piston.state;
  state.offset = std::clamp(state.offset + state.velocity * (time - piston.time),
                            -geometry_.reach(), geometry_.reach());
  return state;
}

GasState ReferenceGas::StateAt(double time) const {
  GasState state;
  for (size_t i = 0; i < balls_.size(); ++i) {
    state.balls.push_back(BallAt(static_cast<int64_t>(i), time));
  }
  for (size_t i = 0; i < pistons_.size(); ++i) {
    state.pistons.push_back(PistonAt(static_cast<int64_t>(i), time));
  }
  return state;
}

}  // namespace ballpiston
