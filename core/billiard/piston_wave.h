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
      : left_(geometry.piston_left()),
        stroke_(geometry.piston_right() - geometry.piston_left()),
        frequency_(1 / (2 * stroke_)) {}

  double left() const { return left_; }
  double stroke() const { return stroke_; }

  double Phase(const PairState& state) const {
    const double way = std::clamp(state.piston - left_, 0.0, stroke_);
    // By its sign bit: a piston at rest keeps it.
    return std::signbit(state.piston_velocity) ? 2 * stroke_ - way : way;
  }
  double Position(double phase) const {
    return left_ + (phase < stroke_ ? phase : 2 * stroke_ - phase);
  }
  // The phase after a way >= 0 from phase 0; 0 or 2 stroke may be off by rounding.
  double Reduced(double way) const {
    const double turns = way * frequency_;
    // The cast costs less than std::floor; beyond, no digit of the phase is left.
    return turns < 0x1p52 ? way - 2 * stroke_ * static_cast<double>(static_cast<int64_t>(turns))
                          : 0;
  }
  double Velocity(double phase, double speed) const { return phase < stroke_ ? speed : -speed; }

  // Where a ball meets the piston: after `way`, with the piston on its way to the right or back.
  struct Meeting {
    double way;
    bool piston_goes_right;
  };
  // The first meeting of a ball that goes at most `length`, from a place `x` to the right of the
  // piston's left wall and not beyond the piston, along a direction with the component `ux`. The
  // piston goes `ratio` times as far. Two that touch and part do not meet there. The piston comes
  // past every ball that is right of its left wall: so they meet before it turns there, or the ball
  // has left its reach.
  std::optional<Meeting> FirstMeeting(double phase, double ratio, double x, double ux,
                                      double length) const {
    double way = 0;
    if (x < 0) {  // to where the piston can be
      if (ux <= 0) return std::nullopt;
      way = -x / ux;
      x = -ux * way;  // so that it is exactly there
      const double periods = (phase + ratio * way) / (2 * stroke_);
      phase = 2 * stroke_ * (periods - std::floor(periods));
    }
    if (phase < stroke_) {
      const double gap = phase - (x + ux * way), approach = ux - ratio, rest = stroke_ - phase;
      const std::optional<double> met = Meet(gap, approach, ratio, rest);
      if (met) return Within(length, {way + *met, true});
      way += rest / ratio;
      phase = stroke_;
    }
    if (way > length) return std::nullopt;
    const double rest = 2 * stroke_ - phase;
    const std::optional<double> met = Meet(rest - (x + ux * way), ux + ratio, ratio, rest);
    return met ? Within(length, {way + *met, false}) : std::nullopt;
  }

  // Whether FirstMeeting may find one; a test of less work, for balls that seldom do. The distance
  // between ball and piston is a concave function of time, except where the piston turns at its
  // left wall. So they meet if the ball ends beyond the piston, or is right of that wall when the
  // piston turns there for the first or the last time. `slack` is a length that rounding may hide.
  bool MayMeet(double phase, double ratio, double x, double ux, double length, double slack) const {
    const double period = 2 * stroke_, after = phase + ratio * length, end = x + ux * length;
    const double last = Reduced(after);
    const bool ends_beyond = end > std::min(last, period - last) - slack;
    const double at_first = x * ratio + ux * (period - phase), at_last = end * ratio - ux * last;
    return ends_beyond |
           ((after >= period - slack) & (std::max(at_first, at_last) > -slack * ratio));
  }

  // Walls hit while it goes `way` further, and 2^63 if there are more.
  uint64_t Hits(double phase, double way) const {
    const double hits = std::floor((phase + way) / stroke_) - std::floor(phase / stroke_);
    return static_cast<uint64_t>(std::min(hits, 0x1p63));
  }

 private:
  // The ball's way until a gap closes, unless the piston has gone the rest of its way before.
  static std::optional<double> Meet(double gap, double approach, double ratio, double rest) {
    gap = std::max(gap, 0.0);  // below 0 by rounding
    if (approach <= 0 || gap * ratio > approach * rest) return std::nullopt;
    return gap / approach;
  }
  static std::optional<Meeting> Within(double length, const Meeting& meeting) {
    return meeting.way <= length ? std::optional(meeting) : std::nullopt;
  }

  double left_;
  double stroke_;
  double frequency_;  // turns at the left wall in a unit of its way
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_BILLIARD_PISTON_WAVE_H_
