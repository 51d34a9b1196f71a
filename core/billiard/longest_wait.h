// The longest time that an orbit may wait for its next ball-piston collision. Rounding can bring an
// orbit into a state from which it never ends: a ball that the piston no longer reaches, or a
// periodic orbit in a cell of few doubles. An orbit that waits longer is counted as lost.
//
// Ball and piston with the speeds v and u meet again after about one of these times:
//   pi A/(v eta)                the ball comes into the piston's reach, of height eta, once
//   2 stroke/u                  the piston comes to its left wall once
//   2 stroke/u  3 A/(eta delta)   it does so while the ball is in its reach, of area > eta delta/3
// In a small cell the discs are nearly flat, and the ball forgets its direction only after about
// sqrt(rho/tip) hits, tip being half the cell's width. The sum times 1/sqrt(tip) is the time scale
// of the law's exponential tail, or longer. An orbit may wait for kLongestWait scales, so a correct
// orbit is lost with a probability below exp(-kLongestWait/10).
//
// A piston that hardly moves, at depth t in the tip, is a wall. The ball finds it after a time of
// order pi A/(v eta(t)), which varies from orbit to orbit without a bound.
//
// Properties, each with a test of its name: 1. EveryOrbitOfTheBilliardIsShorter.
// 2. APistonAtRestThatCannotBeReachedIsNotWaitedFor.
//
// Units: cells over unit speed. Immutable: safe to share between threads.
#pragma once

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

inline constexpr double kLongestWait = 1000;  // in units of the time scale

class LongestWait {
 public:
  explicit LongestWait(const PairGeometry& geometry);

  // From a state just after a collision, or from a start. 0 if they cannot meet.
  double From(const PairState& state) const;

 private:
  double TimeToDepth(double depth, double ball_speed) const;

  PairGeometry geometry_;
  double cell_area_;
  double memory_;       // 1/sqrt(tip)
  double ball_path_;    // pi A/eta
  double piston_path_;  // 2 stroke (1 + 3 A/(eta delta))
  double round_trip_;   // 2 stroke
};

}  // namespace ballpiston
