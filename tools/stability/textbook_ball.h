// The ball of the textbook flows (textbook_flow.h, textbook_gas.h): the velocity is a vector, hit
// times are roots of |q + v t - centre|^2 = rho^2, and a reflection is v - 2 (v.n) n. None of these
// flows restores |v|: it drifts by rounding.
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

namespace ballpiston::stability {

enum class TextbookRule { kPositiveRoot, kAnyRoot, kApproaching, kUnitSpeed };

template <TextbookRule rule>
class TextbookBall {
 public:
  static constexpr int kNone = -1;
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  static constexpr double kThreshold = rule == TextbookRule::kPositiveRoot ? 1e-12 : 0;

  struct Hit {
    double time = kNever;  // from now
    int disc = kNone;
  };

  TextbookBall(double rho, const Eigen::Vector2d& position, const Eigen::Vector2d& velocity)
      : rho_(rho), q_(position), v_(velocity) {
    // A ball on a wall is on the disc in its quadrant.
    const int disc = (q_.x() > 0 ? 1 : 0) | (q_.y() > 0 ? 2 : 0);
    if ((q_ - Centre(disc)).norm() < rho + kOnDisc) last_disc_ = disc;
  }

  const Eigen::Vector2d& position() const { return q_; }
  const Eigen::Vector2d& velocity() const { return v_; }

  Hit NextHit() const {
    Hit hit;
    for (int i = 0; i < 4; ++i) {
      if (const double t = TimeToDisc(i); t < hit.time) hit = {t, i};
    }
    return hit;
  }

  // The time in which ball and piston close this gap at this relative speed.
  static double TimeToMeet(double gap, double approach) {
    const double time = gap / approach;
    const bool by_root = rule == TextbookRule::kPositiveRoot || rule == TextbookRule::kAnyRoot;
    return (by_root ? time > kThreshold : approach > 0) ? time : kNever;
  }

  void Move(double time) { q_ += v_ * time; }

  void Reflect(int disc) {
    const Eigen::Vector2d normal = (q_ - Centre(disc)) / rho_;
    v_ -= 2 * v_.dot(normal) * normal;
    last_disc_ = disc;
  }

  // After an exchange with a piston.
  void SetVelocity(const Eigen::Vector2d& velocity) {
    v_ = velocity;
    last_disc_ = kNone;
  }

 private:
  static constexpr double kOnDisc = 1e-12;

  static Eigen::Vector2d Centre(int disc) {
    return {(disc & 1) != 0 ? 0.5 : -0.5, (disc & 2) != 0 ? 0.5 : -0.5};
  }

  double TimeToDisc(int disc) const {
    const Eigen::Vector2d d = q_ - Centre(disc);
    if (rule == TextbookRule::kUnitSpeed) return TimeAtUnitSpeed(disc, d);
    const double a = v_.squaredNorm(), b = d.dot(v_);
    const double square = b * b - a * (d.squaredNorm() - rho_ * rho_);
    if (square <= 0 || a == 0) return kNever;
    const double first = (-b - std::sqrt(square)) / a, second = (-b + std::sqrt(square)) / a;
    switch (rule) {
      case TextbookRule::kPositiveRoot:
      case TextbookRule::kAnyRoot:
        return first > kThreshold ? first : second > kThreshold ? second : kNever;
      case TextbookRule::kApproaching:
        return b < 0 ? first : kNever;
      case TextbookRule::kUnitSpeed:
        break;
    }
    return kNever;
  }

  // Computed from the foot of the perpendicular and the impact parameter, as for a unit vector.
  double TimeAtUnitSpeed(int disc, const Eigen::Vector2d& d) const {
    const double foot = -d.dot(v_), impact = v_.x() * d.y() - v_.y() * d.x();
    const double square = rho_ * rho_ - impact * impact;
    if (disc == last_disc_ || foot <= 0 || square <= 0) return kNever;
    return std::max(foot - std::sqrt(square), 0.0);
  }

  double rho_;
  Eigen::Vector2d q_;
  Eigen::Vector2d v_;
  int last_disc_ = kNone;
};

}  // namespace ballpiston::stability
