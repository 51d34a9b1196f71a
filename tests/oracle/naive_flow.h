// An independent flow for the comparison of one event. It uses long double, tests every disc, and
// reflects the velocity as v - 2 (v.n) n. It is slow and its energy drifts, but one event from a
// given state is accurate.
#pragma once

#include <cmath>
#include <limits>

#include "core/billiard/reference_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston::oracle {

struct NaiveState {
  long double x, y, z, v1, v2, v3;
};

struct NaiveEvent {
  EventKind kind;
  long double duration;
  NaiveState after;  // reflected by walls; at a ball-piston collision before the exchange
};

inline NaiveState FromPair(const PairState& s) {
  const long double speed = s.ball_speed;
  return {s.position.x(),          s.position.y(),          s.piston,
          speed * s.direction.x(), speed * s.direction.y(), s.piston_velocity};
}

// First root of |q + v t - centre| = rho with the ball approaching; infinity if there is none.
inline long double TimeToDisc(const NaiveState& s, long double cx, long double cy,
                              long double rho) {
  const long double dx = s.x - cx, dy = s.y - cy;
  const long double a = s.v1 * s.v1 + s.v2 * s.v2, b = dx * s.v1 + dy * s.v2;
  const long double c = dx * dx + dy * dy - rho * rho;
  const long double discriminant = b * b - a * c;
  if (b >= 0 || discriminant <= 0) return std::numeric_limits<long double>::infinity();
  // c/(-b + sqrt) is the smaller root without cancellation; rounding may have left c below 0.
  return std::fmax(c / (-b + std::sqrt(discriminant)), 0.0L);
}

inline NaiveEvent NextEvent(const PairGeometry& geometry, const NaiveState& s) {
  const long double rho = geometry.rho(), never = std::numeric_limits<long double>::infinity();
  long double wall = never, cx = 0, cy = 0;
  for (const long double sx : {-0.5L, 0.5L}) {
    for (const long double sy : {-0.5L, 0.5L}) {
      const long double t = TimeToDisc(s, sx, sy, rho);
      if (t < wall) wall = t, cx = sx, cy = sy;
    }
  }
  const long double end = s.v3 > 0 ? geometry.piston_right() : geometry.piston_left();
  const long double piston = s.v3 == 0 ? never : (end - s.z) / s.v3;
  const long double meet = s.v1 > s.v3 ? std::fmax(s.z - s.x, 0.0L) / (s.v1 - s.v3) : never;
  const long double t = std::fmin(wall, std::fmin(piston, meet));
  NaiveState after = {s.x + s.v1 * t, s.y + s.v2 * t, s.z + s.v3 * t, s.v1, s.v2, s.v3};
  if (meet < wall && meet < piston) return {EventKind::kBallPiston, t, after};
  if (piston < wall) {
    after.v3 = -s.v3;
    return {EventKind::kPistonWall, t, after};
  }
  const long double nx = (after.x - cx) / rho, ny = (after.y - cy) / rho;
  const long double normal = s.v1 * nx + s.v2 * ny;
  after.v1 -= 2 * normal * nx;
  after.v2 -= 2 * normal * ny;
  return {EventKind::kBallWall, t, after};
}

}  // namespace ballpiston::oracle
