// The piston between collisions: a triangle wave. Its phase is the way it has gone since it was
// last at its left wall, in [0, 2 stroke): to the right below `stroke`, to the left above.
#ifndef BALLPISTON_CORE_BILLIARD_PISTON_WAVE_H_
#define BALLPISTON_CORE_BILLIARD_PISTON_WAVE_H_

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
      : left_(geometry.piston_left()), stroke_(geometry.piston_right() - geometry.piston_left()) {}

  double left() const { return left_; }
  double stroke() const { return stroke_; }

  double Phase(const PairState& state) const {
    const double way = state.piston - left_;
    // By its sign bit: a piston at rest keeps it.
    return std::signbit(state.piston_velocity) ? 2 * stroke_ - way : way;
  }
  double Position(double phase) const {
    return left_ + (phase < stroke_ ? phase : 2 * stroke_ - phase);
  }
  double Velocity(double phase, double speed) const { return phase < stroke_ ? speed : -speed; }

  // The way of a ball until it meets the piston, from a place `x` to the right of the piston's left
  // wall, along a direction with the component `ux`, at most `length`. The piston goes `ratio`
  // times as far. Two that touch and part do not meet.
  struct Meeting {
    double way;
    bool piston_goes_right;
  };
  std::optional<Meeting> FirstMeeting(double phase, double ratio, double x, double ux,
                                      double length) const {
    double way = 0;
    if (x < 0) {  // to where the piston can be
      way = ux > 0 ? -x / ux : length;
      const double periods = (phase + ratio * way) / (2 * stroke_);
      phase = 2 * stroke_ * (periods - std::floor(periods));
    }
    while (way < length && (x + ux * way > 0 || ux > 0)) {
      const bool right = phase < stroke_;
      const double turn = right ? stroke_ : 2 * stroke_;
      const double gap = std::max((right ? phase : turn - phase) - (x + ux * way), 0.0);
      const double approach = right ? ux - ratio : ux + ratio;
      if (approach > 0 && gap * ratio <= approach * (turn - phase)) {
        way += gap / approach;
        return way <= length ? std::optional<Meeting>({way, right}) : std::nullopt;
      }
      way += (turn - phase) / ratio;
      phase = right ? stroke_ : 0;
    }
    return std::nullopt;
  }

  // Walls hit while it goes `way` further.
  uint64_t Hits(double phase, double way) const {
    return static_cast<uint64_t>(std::floor((phase + way) / stroke_) - std::floor(phase / stroke_));
  }

 private:
  double left_;
  double stroke_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_BILLIARD_PISTON_WAVE_H_
