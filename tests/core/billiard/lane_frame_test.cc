#include "core/billiard/lane_frame.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// Where two discs meet, rounding may put a ball that one disc has reflected into the quadrant of
// the other disc. If the frame were that of the other disc, the ball would fly through that disc.
TEST(LaneFrame, FrameOnATipBelongsToTheDiscThatTheBallLeaves) {
  for (const double rho : {0.5 + 1e-12, 0.501, kPaperRho, 0.7}) {
    const double tip = PairDeltaBound(rho);
    for (const double offset : {-1e-16, -1e-17, -0.0, 0.0, 1e-17, 1e-16}) {
      for (const double side : {-1.0, 1.0}) {
        // Away from the disc on this side, into the opposite disc.
        const Eigen::Vector2d direction = {-0.1 * (1 - 2 * tip), -side};
        for (const Eigen::Vector2d& place :
             {Eigen::Vector2d{tip, offset}, Eigen::Vector2d{-tip, offset}}) {
          const Eigen::Vector2d u =
              Eigen::Vector2d{direction.x() * (place.x() > 0 ? 1 : -1), direction.y()}.normalized();
          const LaneFrame frame = FrameOfBallOnWall(place, u);
          EXPECT_GT(frame.s, 0.4) << "rho " << rho << " offset " << offset;
          EXPECT_NEAR((PositionInCell(frame) - place).norm(), 0, 1e-15);
          EXPECT_NEAR((DirectionInCell(frame) - u).norm(), 0, 1e-15);
        }
      }
    }
  }
}

}  // namespace
}  // namespace ballpiston
