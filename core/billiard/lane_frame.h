// A ball on a wall, as the lanes keep it, and the way back to a position in the cell.
//
// The frame. Its origin is the centre of the disc just left; axes are those of the cell, possibly
// mirrored, such that the cell lies toward (+, +). With u the unit direction of flight and q the
// ball's place, |q| = rho:
//   c = rho sin(phi) = u x (0 - q),   s = rho cos(phi) = u . q >= 0,
//   h = (u_x + u_y)/2,   e = (u_x - u_y)/2,   h^2 + e^2 = 1/2,
// and q = (s u_x + c u_y, s u_y - c u_x). Mirroring x <-> y flips the signs of e and c alone, which
// is why h and e are kept instead of the components.
//
// The compass tells where the cell's right tip is. r is the unit vector of the frame that points to
// the right in the cell: a = r_x + r_y, b = r_x - r_y, both +1 or -1, which turn as h and e do.
// m is the frame's handedness: +1, or -1 if it is a mirror image of the cell.
#ifndef BALLPISTON_CORE_BILLIARD_LANE_FRAME_H_
#define BALLPISTON_CORE_BILLIARD_LANE_FRAME_H_

#include <Eigen/Core>

namespace ballpiston {

struct LaneFrame {
  double h, e, c, s;
  double a, b, m;
};

// A ball on the arc of the disc in its quadrant, flying away from it.
LaneFrame FrameOfBallOnWall(const Eigen::Vector2d& position, const Eigen::Vector2d& direction);

// h, e, c and s times a factor.
LaneFrame Scaled(const LaneFrame& frame, double factor);

// Of the place in the cell, x, without the rounding of a detour through both components.
double Abscissa(const LaneFrame& frame);
Eigen::Vector2d PositionInCell(const LaneFrame& frame);
Eigen::Vector2d DirectionInCell(const LaneFrame& frame);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_BILLIARD_LANE_FRAME_H_
