#include "core/gas/reference_gas.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/billiard/exchange.h"

namespace ballpiston {
namespace {

// After so many events of each body the origin of all times moves to the present. A body passes
// through its cell fewer times, so that times stay as precise as places; the cost is less than one
// event in a thousand.
constexpr uint64_t kEventsFromAnOrigin = 1024;

}  // namespace

ReferenceGas::ReferenceGas(const GasGeometry& geometry, const GasState& state, ThermalWalls walls)
    : geometry_(geometry),
      cell_walls_(geometry.pair()),
      thermal_walls_(std::move(walls)),
      queue_(Place(geometry.pistons())) {
  pistons_.reserve(state.pistons.size());
  for (const GasPiston& piston : state.pistons) {
    TimePiston(pistons_.emplace_back(Piston{.state = piston}));
    SchedulePiston(static_cast<int64_t>(pistons_.size()) - 1);
  }
  balls_.reserve(state.balls.size());
  for (const GasBall& ball : state.balls) {
    Aim(balls_.emplace_back(Ball{.state = ball}));
    LookAround(static_cast<int64_t>(balls_.size()) - 1);
  }
}

GasEvent ReferenceGas::Step() {
  if (++events_ > kEventsFromAnOrigin * (balls_.size() + pistons_.size())) MoveOrigin();
  now_ = queue_.First().time;
  const int64_t body = queue_.First().body, balls = std::ssize(balls_);
  GasEvent event;
  if (body >= balls) {
    event = TurnPiston(body - balls);
  } else {
    const Ball& ball = balls_[Index(body)];
    event = ball.CollisionTime() <= ball.wall_time ? Exchange(body) : HitWall(body);
  }
  event.time = origin_ + now_;
  return event;
}

// Without the last bits of the present time, so that the sum of all moves is exact.
void ReferenceGas::MoveOrigin() {
  constexpr int kBits = 20;
  int exponent;
  const double mantissa = std::frexp(queue_.First().time, &exponent);
  const double later = std::ldexp(std::floor(std::ldexp(mantissa, kBits)), exponent - kBits);
  for (Ball& ball : balls_) {
    ball.time -= later;
    ball.wall_time -= later;
    for (double& time : ball.collision_times) time -= later;
  }
  for (Piston& piston : pistons_) {
    piston.time -= later;
    piston.turn_time -= later;
  }
  queue_.MoveOrigin(later);
  origin_ += later;
  events_ = 0;
}

GasEvent ReferenceGas::HitWall(int64_t number) {
  Ball& ball = balls_[Index(number)];
  if (ball.encounter.disc == kNoDisc) return Stop(number);
  cell_walls_.Reflect(ball.encounter, ball.state.position, ball.state.direction);
  ball.last_disc = ball.encounter.disc;
  ball.time = now_;
  Aim(ball);
  LookAround(number);
  return {.kind = EventKind::kBallWall, .ball = number};
}

// A ball that has escaped rests in the middle of its cell, where no piston comes.
GasEvent ReferenceGas::Stop(int64_t number) {
  Ball& ball = balls_[Index(number)];
  ball = {.state = {}, .time = now_};
  Aim(ball);
  LookAround(number);
  return {.kind = EventKind::kEscape, .ball = number};
}

GasEvent ReferenceGas::TurnPiston(int64_t number) {
  Piston& piston = pistons_[Index(number)];
  GasPiston& state = piston.state;
  piston.time = now_;
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
    if (ball != GasGeometry::kNoBall) LookAgain(ball, side);
  }
  return {.kind = EventKind::kPistonWall, .piston = number, .piston_energy = EnergyOf(state)};
}

// The pair's exchange, in the cell turned until the piston is on the right.
GasEvent ReferenceGas::Exchange(int64_t number) {
  Ball& ball = balls_[Index(number)];
  const Direction direction = ball.first;
  const double sign = SignOf(direction);
  const int64_t piston_number = geometry_.PistonOf(number, direction);
  Piston& piston = pistons_[Index(piston_number)];
  const GasBall ball_there = MovedTo(now_, ball);
  const double offset = MovedTo(now_, piston).offset;
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
  ball.time = piston.time = now_;
  ball.last_disc = kNoDisc;
  Aim(ball);
  TimePiston(piston);
  SchedulePiston(piston_number);
  LookAround(number);
  const Direction opposite = Opposite(direction);
  const int64_t other = geometry_.BallOf(piston_number, opposite);
  if (other != GasGeometry::kNoBall && other != number) LookAgain(other, opposite);
  return {.kind = EventKind::kBallPiston,
          .ball = number,
          .piston = piston_number,
          .direction = direction,
          .ball_energy = EnergyOf(ball.state),
          .piston_energy = EnergyOf(piston.state)};
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

void ReferenceGas::LookAround(int64_t number) {
  Ball& ball = balls_[Index(number)];
  for (int i = 0; i < geometry_.directions(); ++i) {
    FindCollision(ball, number, geometry_.DirectionAt(i));
  }
  ball.origin = origin_;
  Schedule(number);
}

// One of the ball's pistons has changed. Times from before the last move of the origin are less
// precise, so all are found again.
void ReferenceGas::LookAgain(int64_t number, Direction direction) {
  Ball& ball = balls_[Index(number)];
  if (ball.origin != origin_) return LookAround(number);
  FindCollision(ball, number, direction);
  Schedule(number);
}

void ReferenceGas::FindCollision(Ball& ball, int64_t number, Direction direction) const {
  const Piston& piston = pistons_[Index(geometry_.PistonOf(number, direction))];
  ball.collision_times[static_cast<size_t>(direction)] = CollisionTime(ball, direction, piston);
}

// The time of a collision before ball or piston hits a wall. A collision at the moment when the
// piston turns counts, because the piston may never come nearer to a ball at rest.
double ReferenceGas::CollisionTime(const Ball& ball, Direction direction,
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
  Ball& ball = balls_[Index(number)];
  const auto first = std::min_element(ball.collision_times.begin(), ball.collision_times.end());
  ball.first = static_cast<Direction>(first - ball.collision_times.begin());
  queue_.Set(Index(number), std::min(ball.wall_time, *first));
}

void ReferenceGas::SchedulePiston(int64_t number) {
  queue_.Set(Place(number), pistons_[Index(number)].turn_time);
}

GasBall ReferenceGas::MovedTo(double time, const Ball& ball) {
  GasBall state = ball.state;
  state.position += state.direction * (state.speed * (time - ball.time));
  return state;
}

GasPiston ReferenceGas::MovedTo(double time, const Piston& piston) const {
  GasPiston state = piston.state;
  state.offset = std::clamp(state.offset + state.velocity * (time - piston.time),
                            -geometry_.reach(), geometry_.reach());
  return state;
}

GasBall ReferenceGas::BallAt(int64_t number, double time) const {
  return MovedTo(FromOrigin(time), balls_[Index(number)]);
}

GasPiston ReferenceGas::PistonAt(int64_t number, double time) const {
  return MovedTo(FromOrigin(time), pistons_[Index(number)]);
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
