#include "tools/stability/ghost_flight.h"

#include <algorithm>
#include <cmath>

#include "core/billiard/event_flow.h"
#include "core/billiard/piston_wave.h"

namespace ballpiston::stability {
namespace {

// The piston's motion as a function of time.
class PistonInTime {
 public:
  PistonInTime(const PairGeometry& geometry, const PairState& from)
      : wave_(geometry), phase_(wave_.Phase(from)), speed_(std::fabs(from.piston_velocity)) {}

  double Position(double time) const {
    return wave_.Position(std::fmod(phase_ + speed_ * time, Period()));
  }

  // The time of the piston's first turn at its left wall after `time`; infinity if it rests.
  double NextLeftTurn(double time) const {
    if (speed_ == 0) return HUGE_VAL;
    const double way = phase_ + speed_ * time;
    return (std::floor(way / Period() + 1) * Period() - phase_) / speed_;
  }

 private:
  double Period() const { return 2 * wave_.stroke(); }

  PistonWave wave_;
  double phase_;
  double speed_;
};

}  // namespace

GhostFlight FlyAsGhost(const PairGeometry& geometry, const PairState& from, double time) {
  const PistonInTime piston(geometry, from);
  ReferenceFlow ball(geometry, {.position = from.position,
                                .direction = from.direction,
                                .ball_speed = 1,
                                .piston = geometry.piston_right(),
                                .piston_velocity = 0});
  // The distance of the ball to the right of the piston is piecewise linear in time. Its peaks are
  // at the ball's wall hits and at the piston's left turns.
  double overlap = -HUGE_VAL, now = 0;
  for (;;) {
    const double x = ball.state().position.x();
    const double v1 = from.ball_speed * ball.state().direction.x();
    const double hit = now + ball.Step().duration / from.ball_speed;
    const double end = std::min(hit, time), turn = piston.NextLeftTurn(now);
    const auto ahead = [&](double t) { return x + v1 * (t - now) - piston.Position(t); };
    if (turn < end) overlap = std::max(overlap, ahead(turn));
    if (hit >= time) return {.overlap = overlap, .gap = -ahead(time)};
    overlap = std::max(overlap, ahead(hit));
    now = hit;
  }
}

}  // namespace ballpiston::stability
