// Looks at one ball after each of its wall hits.
#ifndef BALLPISTON_TOOLS_STABILITY_BALL_WATCH_H_
#define BALLPISTON_TOOLS_STABILITY_BALL_WATCH_H_

#include <Eigen/Core>
#include <cstdint>

#include "core/geometry/pair_geometry.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

// What rounding may do without harm, in units of the precision's epsilon (2.2e-16 in double).
//   kPositionUlps   An impact parameter carries the rounding of some ten operations; the place on
//                   the disc moves by that over the cosine of the angle to the normal, at a tip
//                   into the neighbouring disc. Deeper inside it: an escape.
//   kDirectionUlps  u.n below minus that: still heading inward.
//   kShortUlps      A flight shorter than that goes nowhere.
inline constexpr double kPositionUlps = 64;
inline constexpr double kDirectionUlps = 16;
inline constexpr double kShortUlps = 4096;

// kShortUlps, but no longer than what is short in a cell that has nearly vanished.
double ShortFlight(const PairGeometry& geometry, double epsilon);

class BallWatch {
 public:
  BallWatch(const PairGeometry& geometry, double epsilon);

  // After a wall hit at the end of a flight of that length. False when the orbit has come to a bad
  // end: it says nothing more.
  bool Hit(const Eigen::Vector2d& position, const Eigen::Vector2d& direction, double length,
           Failures& failures);

  // How far inside a disc; negative outside.
  double Depth(const Eigen::Vector2d& position) const;
  // How well the place of a ball is known that has hit the walls it touches.
  double Slack(const Eigen::Vector2d& position, const Eigen::Vector2d& direction) const;
  bool HeadsInward(const Eigen::Vector2d& position, const Eigen::Vector2d& direction) const;

 private:
  bool IsEscape(double depth, const Eigen::Vector2d& position,
                const Eigen::Vector2d& direction) const;

  double rho_;
  double epsilon_;
  double short_;
  uint64_t longest_sequence_;
  uint64_t sequence_ = 0;  // of short flights up to here
};

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_BALL_WATCH_H_
