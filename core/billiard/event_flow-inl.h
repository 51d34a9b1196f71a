// The functions of EventFlow, for the files that instantiate it. `inline` is a hint: instances are
// weak symbols, and calls between them cost about 8% more instructions than those of a plain class.
#pragma once

#include <algorithm>

#include "core/billiard/event_flow.h"
#include "core/billiard/exchange.h"

namespace ballpiston {

template <typename Real>
EventFlow<Real>::EventFlow(const PairGeometry& geometry, const State& state)
    : walls_(geometry),
      piston_left_(static_cast<Real>(geometry.piston_left())),
      piston_right_(static_cast<Real>(geometry.piston_right())),
      state_(state) {
  AimBall();
  TimePiston();
}

template <typename Real>
EventOf<Real> EventFlow<Real>::Step() {
  const bool wall_first = time_to_wall_ <= time_to_piston_wall_;
  Real duration = wall_first ? time_to_wall_ : time_to_piston_wall_;
  const Real approach = state_.ball_speed * state_.direction.x() - state_.piston_velocity;
  const Real gap = std::max(state_.piston - state_.position.x(), Real(0));
  // <= includes a collision at the moment when the piston turns: the piston may never come nearer
  // to a ball at rest.
  if (approach > 0 && gap <= approach * duration) {
    duration = gap / approach;
    Advance(duration);
    return {EventKind::kBallPiston, duration};
  }
  if (encounter_.disc == kNoDisc && state_.ball_speed > 0) return {EventKind::kEscape, 0};
  Advance(duration);
  if (wall_first) {
    ReflectBall();
    return {EventKind::kBallWall, duration};
  }
  ReflectPiston();
  return {EventKind::kPistonWall, duration};
}

template <typename Real>
inline void EventFlow<Real>::Advance(Real duration) {
  state_.position += state_.direction * (state_.ball_speed * duration);
  state_.piston += state_.piston_velocity * duration;
  time_to_wall_ -= duration;
  time_to_piston_wall_ -= duration;
}

template <typename Real>
inline void EventFlow<Real>::ReflectBall() {
  walls_.Reflect(encounter_, state_.position, state_.direction);
  last_disc_ = encounter_.disc;
  AimBall();
}

template <typename Real>
void EventFlow<Real>::ReflectPiston() {
  state_.piston = state_.piston_velocity > 0 ? piston_right_ : piston_left_;
  state_.piston_velocity = -state_.piston_velocity;
  TimePiston();
}

template <typename Real>
void EventFlow<Real>::ExchangeComponents() {
  state_ = AfterExchange(state_, Real(1));
  last_disc_ = kNoDisc;
  AimBall();
  TimePiston();
}

template <typename Real>
inline void EventFlow<Real>::AimBall() {
  encounter_ = walls_.Next(state_.position, state_.direction, last_disc_);
  time_to_wall_ = state_.ball_speed > 0 ? encounter_.distance / state_.ball_speed : Never();
}

template <typename Real>
inline void EventFlow<Real>::TimePiston() {
  const Real velocity = state_.piston_velocity;
  const Real wall = velocity > 0 ? piston_right_ : piston_left_;
  time_to_piston_wall_ =
      velocity == 0 ? Never() : std::max((wall - state_.piston) / velocity, Real(0));
}

}  // namespace ballpiston
