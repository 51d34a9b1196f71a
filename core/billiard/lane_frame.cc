#include "core/billiard/lane_frame.h"

#include <algorithm>
#include <cmath>

namespace ballpiston {
namespace {

// A ball this near to a tip may be across it by rounding: by ulps, by the root of an ulp if it
// grazes, by 1e-4 in single precision.
constexpr double kOnATip = 1e-3;

// Which disc the ball leaves: the mirrors that bring the cell, seen from that disc's centre, into
// the first quadrant. It is the disc of the ball's quadrant, unless rounding put a ball on a tip to
// the other side of it: there it is the one that the ball does not fly into.
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

// From components in the frame to components in the cell: x along r, y along r turned by a right
// angle, the other way round in a mirror image.
Eigen::Vector2d InCell(const LaneFrame& frame, double x, double y) {
  const double rx = (frame.a + frame.b) / 2, ry = (frame.a - frame.b) / 2;
  return {x * rx + y * ry, frame.m * (y * rx - x * ry)};
}

}  // namespace

LaneFrame FrameOfBallOnWall(const Eigen::Vector2d& position, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d mirrors = MirrorsOfDisc(position, direction);
  const double mx = mirrors.x(), my = mirrors.y();
  const double ux = mx * direction.x(), uy = my * direction.y();
  const double qx = mx * position.x() + 0.5, qy = my * position.y() + 0.5;
  return {.h = (ux + uy) / 2,
          .e = (ux - uy) / 2,
          .c = uy * qx - ux * qy,
          .s = std::max(ux * qx + uy * qy, 0.0),
          .a = mx,
          .b = mx,
          .m = mx * my};
}

LaneFrame Scaled(const LaneFrame& frame, double factor) {
  return {frame.h * factor, frame.e * factor, frame.c * factor, frame.s * factor,
          frame.a,          frame.b,          frame.m};
}

double Abscissa(const LaneFrame& f) {
  // (q_x + q_y - 1)/2 and (q_x - q_y)/2, for x = (q - (1, 1)/2) . r.
  const double along = f.s * f.h - 0.5 - f.c * f.e, across = f.s * f.e + f.c * f.h;
  return f.a * along + f.b * across;
}

Eigen::Vector2d PositionInCell(const LaneFrame& frame) {
  const double x = frame.h + frame.e, y = frame.h - frame.e;
  return InCell(frame, frame.s * x + frame.c * y - 0.5, frame.s * y - frame.c * x - 0.5);
}

Eigen::Vector2d DirectionInCell(const LaneFrame& frame) {
  return InCell(frame, frame.h + frame.e, frame.h - frame.e);
}

}  // namespace ballpiston
