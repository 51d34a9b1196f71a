#include "core/billiard/reference_flow.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ballpiston {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// Discs are numbered by the signs of their centres: bit 0 for x, bit 1 for y.
Eigen::Vector2d Centre(int disc) {
  return {(disc & 1) != 0 ? 0.5 : -0.5, (disc & 2) != 0 ? 0.5 : -0.5};
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

Eigen::Vector2d Perpendicular(const Eigen::Vector2d& a) { return {-a.y(), a.x()}; }

// One Newton step: enough where the length is off from 1 by rounding.
double OneOverLength(const Eigen::Vector2d& a) { return 1.5 - 0.5 * a.squaredNorm(); }

}  // namespace

ReferenceFlow::ReferenceFlow(const PairGeometry& geometry, const PairState& state)
    : rho_(geometry.rho()),
      inverse_rho_(1 / geometry.rho()),
      piston_left_(geometry.piston_left()),
      piston_right_(geometry.piston_right()),
      centres_{Centre(0), Centre(1), Centre(2), Centre(3)},
      state_(state) {
  AimBall();
  TimePiston();
}

Event ReferenceFlow::Step() {
  const bool wall_first = time_to_wall_ <= time_to_piston_wall_;
  double duration = wall_first ? time_to_wall_ : time_to_piston_wall_;
  const double approach = state_.ball_speed * state_.direction.x() - state_.piston_velocity;
  const double gap = std::max(state_.piston - state_.position.x(), 0.0);
  if (gap < approach * duration) {
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

void ReferenceFlow::Advance(double duration) {
  state_.position += state_.direction * (state_.ball_speed * duration);
  state_.piston += state_.piston_velocity * duration;
  time_to_wall_ -= duration;
  time_to_piston_wall_ -= duration;
}

// Along the ray the impact parameter is constant, and centre - hit = s u + c u_perp. The factor
// that keeps the normal's length at 1 is taken from u: it need not wait for the root.
void ReferenceFlow::ReflectBall() {
  const double sin_phi = encounter_.sin_phi, cos_phi = encounter_.cos_phi;
  const double unit = OneOverLength(state_.direction);
  const Eigen::Vector2d normal =
      state_.direction * (-unit * cos_phi) + Perpendicular(state_.direction) * (-unit * sin_phi);
  state_.position = centres_[static_cast<size_t>(encounter_.disc)] + normal * rho_;
  state_.direction = normal * cos_phi + Perpendicular(normal) * sin_phi;
  last_disc_ = encounter_.disc;
  AimBall();
}

void ReferenceFlow::ReflectPiston() {
  state_.piston = state_.piston_velocity > 0 ? piston_right_ : piston_left_;
  state_.piston_velocity = -state_.piston_velocity;
  TimePiston();
}

void ReferenceFlow::ExchangeComponents() {
  const double v1 = state_.ball_speed * state_.direction.x();
  const double v2 = state_.ball_speed * state_.direction.y();
  const double v3 = state_.piston_velocity;
  double ball = std::sqrt(v3 * v3 + v2 * v2), piston = std::fabs(v1);
  if (ball < piston) {
    piston = std::sqrt((1 - ball) * (1 + ball));
  } else {
    ball = std::sqrt((1 - piston) * (1 + piston));
  }
  if (ball > 0) state_.direction = {v3 / ball, v2 / ball};
  state_.direction *= OneOverLength(state_.direction);
  state_.ball_speed = ball;
  state_.position.x() = state_.piston;
  state_.piston_velocity = std::copysign(piston, v1);
  last_disc_ = kNoDisc;
  AimBall();
  TimePiston();
}

void ReferenceFlow::AimBall() {
  encounter_ = NextDisc();
  time_to_wall_ = state_.ball_speed > 0 ? encounter_.distance / state_.ball_speed : kNever;
}

void ReferenceFlow::TimePiston() {
  const double velocity = state_.piston_velocity;
  const double wall = velocity > 0 ? piston_right_ : piston_left_;
  time_to_piston_wall_ = velocity == 0 ? kNever : std::max((wall - state_.piston) / velocity, 0.0);
}

ReferenceFlow::Encounter ReferenceFlow::NextDisc() const {
  // The ball is inside the unit cell, so it moves away from the centre in the quadrant behind it.
  const int behind = (state_.direction.x() < 0 ? 1 : 0) | (state_.direction.y() < 0 ? 2 : 0);
  const std::array<Encounter, 3> discs = {Meet(behind ^ 1), Meet(behind ^ 2), Meet(behind ^ 3)};
  // Which one is hit is as good as random: an index costs less here than mispredicted jumps do.
  const size_t beside = discs[1].distance < discs[0].distance;
  const size_t ahead = discs[2].distance < discs[beside].distance;
  return discs[std::max(beside, 2 * ahead)];
}

ReferenceFlow::Encounter ReferenceFlow::Meet(int disc) const {
  const Eigen::Vector2d to_centre = centres_[static_cast<size_t>(disc)] - state_.position;
  const double foot = state_.direction.dot(to_centre);
  const double impact = Cross(state_.direction, to_centre);
  const double square = rho_ * rho_ - impact * impact;
  const bool hit = (disc != last_disc_) & (foot > 0) & (square > 0);
  const double half_chord = std::sqrt(hit ? square : 0);
  const double distance = std::max(foot - half_chord, 0.0);
  return {hit ? disc : kNoDisc, hit ? distance : kNever, impact * inverse_rho_,
          half_chord * inverse_rho_};
}

}  // namespace ballpiston
