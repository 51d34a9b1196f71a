// The billiard flow as in a textbook (textbook_ball.h describes its rules). Each rule looks correct
// and fails in some situation. A stable flow is compared with these rules.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>

#include "core/billiard/reference_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/stability/textbook_ball.h"

namespace ballpiston::stability {

// The same interface as ReferenceFlow.
template <TextbookRule rule>
class TextbookFlow {
 public:
  TextbookFlow(const PairGeometry& geometry, const PairState& start)
      : geometry_(geometry),
        ball_(geometry.rho(), start.position, start.direction * start.ball_speed),
        piston_(start.piston),
        piston_velocity_(start.piston_velocity) {}

  Event Step() {
    const auto [wall, disc] = ball_.NextHit();
    const double piston = TimeToPistonWall();
    const double meet =
        Ball::TimeToMeet(piston_ - ball_.position().x(), ball_.velocity().x() - piston_velocity_);
    const double first = std::min({wall, piston, meet});
    const bool is_lost = disc == Ball::kNone && ball_.velocity().squaredNorm() > 0;
    if (first == Ball::kNever || is_lost) return {EventKind::kEscape, 0};
    ball_.Move(first);
    piston_ += piston_velocity_ * first;
    if (meet == first) return {EventKind::kBallPiston, first};
    if (piston == first) {
      piston_velocity_ = -piston_velocity_;
      return {EventKind::kPistonWall, first};
    }
    ball_.Reflect(disc);
    return {EventKind::kBallWall, first};
  }

  void ExchangeComponents() {
    Eigen::Vector2d velocity = ball_.velocity();
    std::swap(velocity.x(), piston_velocity_);
    ball_.SetVelocity(velocity);
  }

  PairState state() const {
    const double speed = ball_.velocity().norm();
    PairState state = {.position = ball_.position(),
                       .ball_speed = speed,
                       .piston = piston_,
                       .piston_velocity = piston_velocity_};
    if (speed > 0) state.direction = ball_.velocity() / speed;
    return state;
  }

 private:
  using Ball = TextbookBall<rule>;

  double TimeToPistonWall() const {
    if (piston_velocity_ == 0) return Ball::kNever;
    const double wall = piston_velocity_ > 0 ? geometry_.piston_right() : geometry_.piston_left();
    return (wall - piston_) / piston_velocity_;
  }

  PairGeometry geometry_;
  Ball ball_;
  double piston_;
  double piston_velocity_;
};

}  // namespace ballpiston::stability
