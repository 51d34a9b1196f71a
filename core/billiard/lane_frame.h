// The representation of a ball in the lanes, and the conversion to a position in the cell. The ball
// is on a wall, except after FrameOfBall.
//
// The frame. Its origin is the centre of the disc just left. Its axes are those of the cell,
// possibly mirrored, such that the cell lies toward (+, +). With u the unit direction of flight and
// q the ball's position, |q| = rho on the wall:
//   c = rho sin(phi) = u x (0 - q),   s = rho cos(phi) = u . q >= 0,
//   h = (u_x + u_y)/2,   e = (u_x - u_y)/2,   h^2 + e^2 = 1/2,
// and q = (s u_x + c u_y, s u_y - c u_x). The mirror image x <-> y changes only the signs of e and
// c. Therefore the frame stores h and e instead of the components.
//
// The compass gives the direction of the cell's right tip. r is the unit vector of the frame that
// points to the right in the cell: a = r_x + r_y, b = r_x - r_y. Both are +1 or -1, and turn like h
// and e. m is the frame's handedness: +1, or -1 if the frame is a mirror image of the cell.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace ballpiston {

struct LaneFrame {
  double h, e, c, s;
  double a, b, m;
};

// `mirrors`, each -1 or +1, convert the cell's axes into the frame's.
inline LaneFrame SeenIn(const Eigen::Vector2d& mirrors, const Eigen::Vector2d& position,
                        const Eigen::Vector2d& direction) {
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

// A ball anywhere in the cell, in the frame of the disc behind it. |q| may be larger than rho; all
// other relations hold as for a ball on that disc.
inline LaneFrame FrameOfBall(const Eigen::Vector2d& position, const Eigen::Vector2d& direction) {
  return SeenIn({std::copysign(1, direction.x()), std::copysign(1, direction.y())}, position,
                direction);
}

// A ball on the arc of the disc in its quadrant, flying away from it.
LaneFrame FrameOfBallOnWall(const Eigen::Vector2d& position, const Eigen::Vector2d& direction);

// h, e, c and s times a factor.
inline LaneFrame Scaled(const LaneFrame& frame, double factor) {
  return {frame.h * factor, frame.e * factor, frame.c * factor, frame.s * factor,
          frame.a,          frame.b,          frame.m};
}

// Converts components in the frame to components in the cell: x along r, y along r turned by a
// right angle (in the opposite sense if the frame is a mirror image).
inline Eigen::Vector2d InCell(const LaneFrame& frame, double x, double y) {
  const double rx = (frame.a + frame.b) / 2, ry = (frame.a - frame.b) / 2;
  return {x * rx + y * ry, frame.m * (y * rx - x * ry)};
}

inline Eigen::Vector2d PositionInCell(const LaneFrame& frame) {
  const double x = frame.h + frame.e, y = frame.h - frame.e;
  return InCell(frame, frame.s * x + frame.c * y - 0.5, frame.s * y - frame.c * x - 0.5);
}

inline Eigen::Vector2d DirectionInCell(const LaneFrame& frame) {
  return InCell(frame, frame.h + frame.e, frame.h - frame.e);
}

}  // namespace ballpiston
