// An independent flow for the comparison of one event. It uses long double, tests every disc, and
// reflects the velocity as v - 2 (v.n) n. It is slow and its energy drifts, but one event from a
// given state is accurate.
#pragma once

#include <cmath>
#include <limits>

#include "core/billiard/event_flow.h"
#include "core/geometry/pair_state.h"
#include "tests/oracle/exact_flight.h"

namespace ballpiston::oracle {

struct NaiveState {
  long double x, y, z, v1, v2, v3;
};

struct NaiveEvent {
  EventKind kind;
  long double duration;
  NaiveState after;  // reflected by walls; at a ball-piston collision before the exchange
};

// The ball moves.
inline NaiveEvent NextEvent(const PairGeometry& geometry, const PairState& s) {
  constexpr int kNoDisc = -1;
  const long double never = std::numeric_limits<long double>::infinity(), speed = s.ball_speed;
  const long double v1 = speed * s.direction.x(), v2 = speed * s.direction.y(),
                    v3 = s.piston_velocity;
  const ExactFlight<long double> flight(geometry, s.position, s.direction, kNoDisc);
  // Rounding may have left the ball inside of the disc.
  const long double wall = std::fmax(flight.First().length, 0.0L) / speed;
  const long double end = v3 > 0 ? geometry.piston_right() : geometry.piston_left();
  const long double piston = v3 == 0 ? never : (end - s.piston) / v3;
  const long double ahead = std::fmax(s.piston - static_cast<long double>(s.position.x()), 0.0L);
  const long double meet = v1 > v3 ? ahead / (v1 - v3) : never;
  const long double t = std::fmin(wall, std::fmin(piston, meet));
  NaiveState after = {
      s.position.x() + v1 * t, s.position.y() + v2 * t, s.piston + v3 * t, v1, v2, v3};
  if (meet < wall && meet < piston) return {EventKind::kBallPiston, t, after};
  if (piston < wall) {
    after.v3 = -v3;
    return {EventKind::kPistonWall, t, after};
  }
  const Eigen::Vector2d centre = DiscCentre(flight.first);
  const long double nx = (after.x - centre.x()) / geometry.rho(),
                    ny = (after.y - centre.y()) / geometry.rho();
  const long double normal = v1 * nx + v2 * ny;
  after.v1 -= 2 * normal * nx;
  after.v2 -= 2 * normal * ny;
  return {EventKind::kBallWall, t, after};
}

}  // namespace ballpiston::oracle
