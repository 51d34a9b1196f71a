// Checks one ball after each of its wall hits.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/geometry/pair_geometry.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

// The harmless effects of rounding, in units of the precision's epsilon (2.2e-16 in double).
//   kPositionUlps   An impact parameter has the rounding error of about ten operations. The
//                   position on the disc moves by this error over the cosine of the angle to the
//                   normal; at a tip it moves into the neighbouring disc. A ball deeper inside a
//                   disc has escaped.
//   kDirectionUlps  If u.n is below minus this value, the ball still heads inward.
//   kShortUlps      A shorter flight counts as no motion.
inline constexpr double kPositionUlps = 64;
inline constexpr double kDirectionUlps = 16;
inline constexpr double kShortUlps = 4096;

// kShortUlps; less in a cell that has nearly vanished.
double ShortFlight(const PairGeometry& geometry, double epsilon);

// ---- standstill ----
//
// The largest number of successive hits in a tip. It distinguishes a true cusp sequence from an
// orbit that stands still.
//
// Two discs meet at a tip at angles +-theta to the axis, tan(theta) = lambda. Between straight
// walls at that angle the orbit unfolds to a straight line, which crosses at most pi/(2 theta) of
// their images. Between the discs there are no more hits, because the discs open wider than their
// tangents. Flights much shorter than the cell are flights between two neighbouring discs near
// their tip. A longer sequence of such flights is not an orbit: it repeats its state, or rounding
// has moved it out of the cell.

// 5 at the paper's radius, 800 at rho - 1/2 = 1e-6, 800,000 at 1e-12; rounding may add a few.
inline uint64_t LongestTipSequence(const PairGeometry& geometry) {
  return static_cast<uint64_t>(std::numbers::pi / (2 * std::atan(geometry.lambda()))) + 8;
}

// The largest number of successive events without time between them. In a corner of walls and
// piston there are a few hits. If the piston presses the ball into a tip, there is a tip sequence
// between any two of these hits.
inline uint64_t LongestStandstill(const PairGeometry& geometry) {
  return 64 + 4 * LongestTipSequence(geometry);
}

// Counts successive flights, or events, that are too short to be motion.
class Standstill {
 public:
  Standstill(double short_flight, uint64_t most) : short_(short_flight), most_(most) {}

  // Counts a loop and returns true if there are more in succession than an orbit can have.
  bool See(double length, Failures& failures) {
    count_ = length < short_ ? count_ + 1 : 0;
    failures.loops += count_ > most_;
    return count_ > most_;
  }

 private:
  double short_;
  uint64_t most_;
  uint64_t count_ = 0;
};

class BallWatch {
 public:
  BallWatch(const PairGeometry& geometry, double epsilon);

  // Call it after each wall hit; `length` is the length of the flight before the hit. Returns false
  // if the orbit has failed: then it must not be continued.
  bool Hit(const Eigen::Vector2d& position, const Eigen::Vector2d& direction, double length,
           Failures& failures);

  // Checks a ball anywhere in the cell. Returns false if it is too deep inside a disc, or nowhere:
  // this counts as an escape.
  bool IsInCell(const Eigen::Vector2d& position, Failures& failures) const;

  // The error of the position of a ball that has hit the walls that it touches.
  double Slack(const Eigen::Vector2d& position, const Eigen::Vector2d& direction) const;
  bool HeadsInward(const Eigen::Vector2d& position, const Eigen::Vector2d& direction) const;

 private:
  // The depth inside a disc; negative outside.
  double Depth(const Eigen::Vector2d& position) const;

  double rho_;
  double epsilon_;
  Standstill standstill_;
};

}  // namespace ballpiston::stability
