#include "core/billiard/lane_frame.h"

#include <cmath>

namespace ballpiston {
namespace {

// Rounding may put a ball this near to a tip on the other side of it: by ulps, by the root of an
// ulp if it grazes, by 1e-4 in single precision.
constexpr double kOnATip = 1e-3;

// Returns the mirrors for the disc that the ball leaves: they bring the cell, seen from that disc's
// centre, into the first quadrant. This is the disc of the ball's quadrant, unless rounding has put
// a ball on a tip on the wrong side. At a tip it is the disc that the ball does not fly into.
Eigen::Vector2d MirrorsOfDisc(const Eigen::Vector2d& position, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d quadrant = {position.x() > 0 ? -1 : 1, position.y() > 0 ? -1 : 1};
  const auto leaves = [&](const Eigen::Vector2d& m) {
    return direction.dot(position + m / 2) >= 0;
  };
  if (leaves(quadrant)) return quadrant;
  for (const Eigen::Index axis : {0, 1}) {
    Eigen::Vector2d beside = quadrant;
    beside[axis] *= -1;
    if (std::fabs(position[axis]) < kOnATip && leaves(beside)) return beside;
  }
  return quadrant;
}

}  // namespace

LaneFrame FrameOfBallOnWall(const Eigen::Vector2d& position, const Eigen::Vector2d& direction) {
  return SeenIn(MirrorsOfDisc(position, direction), position, direction);
}

}  // namespace ballpiston
