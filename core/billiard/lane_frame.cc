#include "core/billiard/lane_frame.h"

#include <algorithm>

namespace ballpiston {
namespace {

// From components in the frame to components in the cell: x along r, y along r turned by a right
// angle, the other way round in a mirror image.
Eigen::Vector2d InCell(const LaneFrame& frame, double x, double y) {
  const double rx = (frame.a + frame.b) / 2, ry = (frame.a - frame.b) / 2;
  return {x * rx + y * ry, frame.m * (y * rx - x * ry)};
}

}  // namespace

LaneFrame FrameOfBallOnWall(const Eigen::Vector2d& position, const Eigen::Vector2d& direction) {
  // Mirrors that bring the cell, seen from the disc's centre, into the first quadrant.
  const double mx = position.x() > 0 ? -1 : 1, my = position.y() > 0 ? -1 : 1;
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

Eigen::Vector2d PositionInCell(const LaneFrame& frame) {
  const double x = frame.h + frame.e, y = frame.h - frame.e;
  return InCell(frame, frame.s * x + frame.c * y - 0.5, frame.s * y - frame.c * x - 0.5);
}

Eigen::Vector2d DirectionInCell(const LaneFrame& frame) {
  return InCell(frame, frame.h + frame.e, frame.h - frame.e);
}

}  // namespace ballpiston
