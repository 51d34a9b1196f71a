// The piston between collisions: a triangle wave. Its phase is the path length since it was last at
// its left wall, in [0, 2 stroke). Below `stroke` the piston moves to the right, above to the left.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

class PistonWave {
 public:
  explicit PistonWave(const PairGeometry& geometry)
      : left_(geometry.piston_left()),
        stroke_(geometry.piston_right() - geometry.piston_left()),
        frequency_(1 / (2 * stroke_)) {}

  double left() const { return left_; }
  double stroke() const { return stroke_; }

  double Phase(const PairState& state) const {
    const double way = std::clamp(state.piston - left_, 0.0, stroke_);
    // The sign bit gives the direction; a piston at rest keeps its sign bit.
    return std::signbit(state.piston_velocity) ? 2 * stroke_ - way : way;
  }
  double Position(double phase) const {
    return left_ + (phase < stroke_ ? phase : 2 * stroke_ - phase);
  }
  // The phase after a path of length `way` >= 0 from phase 0. Rounding may give a result just
  // outside of [0, 2 stroke).
  double Reduced(double way) const {
    const double turns = way * frequency_;
    // The cast costs less than std::floor. Above 2^52 turns the phase has no correct digit.
    return turns < 0x1p52 ? way - 2 * stroke_ * static_cast<double>(static_cast<int64_t>(turns))
                          : 0;
  }

  // A collision of ball and piston: the ball's path length `way` until then, and the direction in
  // which the piston moves.
  struct Collision {
    double way;
    bool piston_goes_right;
  };
  // The first collision of piston and ball. The ball goes at most `length`, from a distance `x`
  // right of the piston's left wall and not beyond the piston, along a direction with the component
  // `ux`. The piston goes `ratio` times as far. A ball and a piston that touch and move apart do
  // not meet. The piston passes every ball that is right of the piston's left wall. So they meet
  // before the piston turns there, or the ball has left the piston's reach.
  std::optional<Collision> FirstCollision(double phase, double ratio, double x, double ux,
                                          double length) const {
    double way = 0;
    if (x < 0) {  // the ball first flies to the piston's left wall
      if (ux <= 0) return std::nullopt;
      way = -x / ux;
      x = -ux * way;  // so that x + ux way is exactly 0
      const double periods = (phase + ratio * way) / (2 * stroke_);
      phase = 2 * stroke_ * (periods - std::floor(periods));
    }
    if (phase < stroke_) {
      const double gap = phase - (x + ux * way), approach = ux - ratio, rest = stroke_ - phase;
      const std::optional<double> met = WayToClose(gap, approach, ratio, rest);
      if (met) return Within(length, {way + *met, true});
      way += rest / ratio;
      phase = stroke_;
    }
    if (way > length) return std::nullopt;
    const double rest = 2 * stroke_ - phase;
    const std::optional<double> met = WayToClose(rest - (x + ux * way), ux + ratio, ratio, rest);
    return met ? Within(length, {way + *met, false}) : std::nullopt;
  }

  // The piston's path until it meets a ball at rest, `x` right of the piston's left wall and not
  // beyond the piston; a ball that rounding has put beyond the piston is met at once. Empty if the
  // piston does not come so far.
  std::optional<double> WayToBallAtRest(double phase, double x) const {
    if (x < 0) return std::nullopt;
    return std::max(2 * stroke_ - x - phase, 0.0);
  }

  // The number of walls that the piston hits while it goes `way` further; at most 2^63.
  uint64_t Hits(double phase, double way) const {
    const double hits = std::floor((phase + way) / stroke_) - std::floor(phase / stroke_);
    return static_cast<uint64_t>(std::min(hits, 0x1p63));
  }

 private:
  // The ball's path length until a gap closes; empty if the piston turns before.
  static std::optional<double> WayToClose(double gap, double approach, double ratio, double rest) {
    gap = std::max(gap, 0.0);  // below 0 by rounding
    if (approach <= 0 || gap * ratio > approach * rest) return std::nullopt;
    return gap / approach;
  }
  static std::optional<Collision> Within(double length, const Collision& collision) {
    return collision.way <= length ? std::optional(collision) : std::nullopt;
  }

  double left_;
  double stroke_;
  double frequency_;  // turns at the left wall per unit of path length
};

}  // namespace ballpiston
