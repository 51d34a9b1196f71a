// The functions of EventFlow, for the files that instantiate it. `inline` as a hint: instances are
// weak symbols, calls between which cost some 8% more instructions than those of a plain class did.
#ifndef BALLPISTON_CORE_BILLIARD_EVENT_FLOW_INL_H_
#define BALLPISTON_CORE_BILLIARD_EVENT_FLOW_INL_H_

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/billiard/event_flow.h"
#include "core/billiard/exchange.h"

namespace ballpiston {

template <typename Real>
struct EventFlow<Real>::Plane {
  static constexpr Real Never() { return std::numeric_limits<Real>::infinity(); }

  // Discs are numbered by the signs of their centres: bit 0 for x, bit 1 for y.
  static Vector Centre(int disc) {
    return {static_cast<Real>((disc & 1) != 0 ? 0.5 : -0.5),
            static_cast<Real>((disc & 2) != 0 ? 0.5 : -0.5)};
  }

  static Real Cross(const Vector& a, const Vector& b) { return a.x() * b.y() - a.y() * b.x(); }
  static Vector Perpendicular(const Vector& a) { return {-a.y(), a.x()}; }
};

template <typename Real>
EventFlow<Real>::EventFlow(const PairGeometry& geometry, const State& state)
    : rho_(static_cast<Real>(geometry.rho())),
      inverse_rho_(1 / rho_),
      piston_left_(static_cast<Real>(geometry.piston_left())),
      piston_right_(static_cast<Real>(geometry.piston_right())),
      centres_{Plane::Centre(0), Plane::Centre(1), Plane::Centre(2), Plane::Centre(3)},
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
  // Also where they meet as the piston turns: it may never come nearer to a ball at rest.
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

// Along the ray the impact parameter is constant, and centre - hit = s u + c u_perp. The factor
// that keeps the normal's length at 1 is taken from u: it need not wait for the root.
template <typename Real>
inline void EventFlow<Real>::ReflectBall() {
  const Real sin_phi = encounter_.sin_phi, cos_phi = encounter_.cos_phi;
  const Real unit = OneOverLength(state_.direction);
  const Vector normal = state_.direction * (-unit * cos_phi) +
                        Plane::Perpendicular(state_.direction) * (-unit * sin_phi);
  state_.position = centres_[static_cast<size_t>(encounter_.disc)] + normal * rho_;
  state_.direction = normal * cos_phi + Plane::Perpendicular(normal) * sin_phi;
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
  state_ = AfterExchange(state_);
  last_disc_ = kNoDisc;
  AimBall();
  TimePiston();
}

template <typename Real>
inline void EventFlow<Real>::AimBall() {
  encounter_ = NextDisc();
  time_to_wall_ = state_.ball_speed > 0 ? encounter_.distance / state_.ball_speed : Plane::Never();
}

template <typename Real>
inline void EventFlow<Real>::TimePiston() {
  const Real velocity = state_.piston_velocity;
  const Real wall = velocity > 0 ? piston_right_ : piston_left_;
  time_to_piston_wall_ =
      velocity == 0 ? Plane::Never() : std::max((wall - state_.piston) / velocity, Real(0));
}

template <typename Real>
inline typename EventFlow<Real>::Encounter EventFlow<Real>::NextDisc() const {
  // The ball is inside the unit cell, so it moves away from the centre in the quadrant behind it.
  const int behind = (state_.direction.x() < 0 ? 1 : 0) | (state_.direction.y() < 0 ? 2 : 0);
  const std::array<Encounter, 3> discs = {Meet(behind ^ 1), Meet(behind ^ 2), Meet(behind ^ 3)};
  // Which one is hit is as good as random: an index costs less here than mispredicted jumps do.
  const size_t beside = discs[1].distance < discs[0].distance;
  const size_t ahead = discs[2].distance < discs[beside].distance;
  return discs[std::max(beside, 2 * ahead)];
}

template <typename Real>
inline typename EventFlow<Real>::Encounter EventFlow<Real>::Meet(int disc) const {
  using std::sqrt;
  const Vector to_centre = centres_[static_cast<size_t>(disc)] - state_.position;
  const Real foot = state_.direction.dot(to_centre);
  const Real impact = Plane::Cross(state_.direction, to_centre);
  const Real square = rho_ * rho_ - impact * impact;
  // The operator is & and not &&: && makes a branch for each condition, and those are mispredicted.
  const int hit = int{disc != last_disc_} & int{foot > 0} & int{square > 0};
  const Real half_chord = sqrt(hit ? square : Real(0));
  const Real distance = std::max(foot - half_chord, Real(0));
  return {hit ? disc : kNoDisc, hit ? distance : Plane::Never(), impact * inverse_rho_,
          half_chord * inverse_rho_};
}

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_BILLIARD_EVENT_FLOW_INL_H_
