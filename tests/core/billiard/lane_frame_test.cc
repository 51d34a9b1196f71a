#include "core/billiard/lane_frame.h"

#include "core/billiard/reference_flow.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"
#include "tools/flows/lane_balls.h"

namespace ballpiston {
namespace {

// Balls anywhere in the cell, in any direction: the conversion to the frame and back is the
// identity, and the next wall hit is that of the reference.
TEST(LaneFrame, BallInTheCellReachesTheNextWallOfTheReference) {
  for (const double rho : {0.501, kPaperRho, 0.7}) {
    const PairGeometry geometry = GeometryAtShare(rho, 0.3);
    for (uint64_t i = 0; i < 3000; ++i) {
      CounterRandom random(1, 2, i);
      PairState state = DrawFromFlowMeasure(geometry, random);
      const LaneFrame frame = FrameOfBall(state.position, state.direction);
      ASSERT_NEAR((PositionInCell(frame) - state.position).norm(), 0, 1e-15);
      ASSERT_NEAR((DirectionInCell(frame) - state.direction).norm(), 0, 1e-15);
      state.piston = geometry.piston_right();
      state.piston_velocity = 0;
      state.ball_speed = 1;
      ReferenceFlow flow(geometry, state);
      const Event event = flow.Step();
      if (event.kind != EventKind::kBallWall) continue;
      LaneHit hit[1];
      FlyLaneBalls(geometry, {&frame, 1}, 1, hit);
      ASSERT_NEAR(hit[0].length, event.duration, 1e-13);
      ASSERT_NEAR((PositionInCell(hit[0].frame) - flow.state().position).norm(), 0, 1e-13);
      ASSERT_NEAR((DirectionInCell(hit[0].frame) - flow.state().direction).norm(), 0, 1e-12);
    }
  }
}

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
