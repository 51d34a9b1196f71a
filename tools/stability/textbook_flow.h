// The billiard flow as in a textbook: the ball's velocity is a vector, hit times are roots of
// |q + v t - centre|^2 = rho^2, and a reflection is v - 2 (v.n) n. |v| is not restored: it drifts
// by rounding. Each rule looks correct and fails in some situation. A stable flow is compared with
// these rules.
//
// The rules differ in how they prevent that the same hit is found again:
//   kPositiveRoot  any root counts that is more than a threshold ahead. At a tip the next hit may
//                  be nearer than the threshold: the rule ignores it, and the ball leaves through
//                  the disc.
//   kAnyRoot       the same without a threshold. If rounding has left the ball an ulp outside, it
//                  hits the same disc again at once, and again: the orbit stands still.
//   kApproaching   the first root of the discs that the ball approaches. If rounding has left the
//                  ball inside a neighbouring disc, this root is negative, and the ball moves back.
//   kUnitSpeed     the disc just hit is excluded and times are clamped at 0, which would be enough.
//                  But the hit time assumes |v| = 1, and the reflection does not. The error of |v|
//                  goes into the position, from there back into |v|, and grows.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/billiard/event_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston::stability {

enum class TextbookRule { kPositiveRoot, kAnyRoot, kApproaching, kUnitSpeed };

// The same interface as ReferenceFlow.
template <TextbookRule rule>
class TextbookFlow {
 public:
  TextbookFlow(const PairGeometry& geometry, const PairState& start)
      : geometry_(geometry),
        q_(start.position),
        v_(start.direction * start.ball_speed),
        piston_(start.piston),
        piston_velocity_(start.piston_velocity) {
    // A ball on a wall is on the disc in its quadrant.
    const int disc = (q_.x() > 0 ? 1 : 0) | (q_.y() > 0 ? 2 : 0);
    if ((q_ - Centre(disc)).norm() < geometry.rho() + kOnDisc) last_disc_ = disc;
  }

  Event Step() {
    const auto [wall, disc] = NextHit();
    const double piston = TimeToPistonWall(), meet = TimeToMeet();
    const double first = std::min({wall, piston, meet});
    const bool is_lost = disc == kNone && v_.squaredNorm() > 0;
    if (first == kNever || is_lost) return {EventKind::kEscape, 0};
    q_ += v_ * first;
    piston_ += piston_velocity_ * first;
    if (meet == first) return {EventKind::kBallPiston, first};
    if (piston == first) {
      piston_velocity_ = -piston_velocity_;
      return {EventKind::kPistonWall, first};
    }
    Reflect(disc);
    return {EventKind::kBallWall, first};
  }

  void ExchangeComponents() {
    std::swap(v_.x(), piston_velocity_);
    last_disc_ = kNone;
  }

  PairState state() const { return WithVelocities(q_, v_, piston_, piston_velocity_); }

 private:
  static constexpr int kNone = -1;
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  static constexpr double kThreshold = rule == TextbookRule::kPositiveRoot ? 1e-12 : 0;
  static constexpr double kOnDisc = 1e-12;

  struct Hit {
    double time = kNever;  // from now
    int disc = kNone;
  };

  static Eigen::Vector2d Centre(int disc) {
    return {(disc & 1) != 0 ? 0.5 : -0.5, (disc & 2) != 0 ? 0.5 : -0.5};
  }

  Hit NextHit() const {
    Hit hit;
    for (int i = 0; i < 4; ++i) {
      if (const double t = TimeToDisc(i); t < hit.time) hit = {t, i};
    }
    return hit;
  }

  double TimeToDisc(int disc) const {
    const Eigen::Vector2d d = q_ - Centre(disc);
    if (rule == TextbookRule::kUnitSpeed) return TimeAtUnitSpeed(disc, d);
    const double a = v_.squaredNorm(), b = d.dot(v_);
    const double square = b * b - a * (d.squaredNorm() - geometry_.rho() * geometry_.rho());
    if (square <= 0 || a == 0) return kNever;
    const double first = (-b - std::sqrt(square)) / a, second = (-b + std::sqrt(square)) / a;
    if (rule == TextbookRule::kApproaching) return b < 0 ? first : kNever;
    return first > kThreshold ? first : second > kThreshold ? second : kNever;
  }

  // Computed from the foot of the perpendicular and the impact parameter, as for a unit vector.
  double TimeAtUnitSpeed(int disc, const Eigen::Vector2d& d) const {
    const double foot = -d.dot(v_), impact = v_.x() * d.y() - v_.y() * d.x();
    const double square = geometry_.rho() * geometry_.rho() - impact * impact;
    if (disc == last_disc_ || foot <= 0 || square <= 0) return kNever;
    return std::max(foot - std::sqrt(square), 0.0);
  }

  double TimeToPistonWall() const {
    if (piston_velocity_ == 0) return kNever;
    const double wall = piston_velocity_ > 0 ? geometry_.piston_right() : geometry_.piston_left();
    return (wall - piston_) / piston_velocity_;
  }

  double TimeToMeet() const {
    const double approach = v_.x() - piston_velocity_, time = (piston_ - q_.x()) / approach;
    const bool by_root = rule == TextbookRule::kPositiveRoot || rule == TextbookRule::kAnyRoot;
    return (by_root ? time > kThreshold : approach > 0) ? time : kNever;
  }

  void Reflect(int disc) {
    const Eigen::Vector2d normal = (q_ - Centre(disc)) / geometry_.rho();
    v_ -= 2 * v_.dot(normal) * normal;
    last_disc_ = disc;
  }

  PairGeometry geometry_;
  Eigen::Vector2d q_;
  Eigen::Vector2d v_;
  double piston_;
  double piston_velocity_;
  int last_disc_ = kNone;
};

}  // namespace ballpiston::stability
