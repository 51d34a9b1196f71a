// The piston between collisions: a triangle wave. Its phase is the way it has gone since it was
// last at its left wall, in [0, 2 stroke): to the right below `stroke`, to the left above.
#ifndef BALLPISTON_CORE_BILLIARD_PISTON_WAVE_H_
#define BALLPISTON_CORE_BILLIARD_PISTON_WAVE_H_

#include <cmath>
#include <cstdint>

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
