#include "tools/flows/fixed_step_flow.h"

#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

TEST(FixedStepFlow, EnergyStaysExact) {
  CounterRandom random(3, 0, 0);
  FixedStepFlow flow(kPaperPair, DrawFromFlowMeasure(kPaperPair, random), 1e-3);
  for (int i = 0; i < 30'000; ++i) {
    const EventKind kind = flow.Step().kind;
    ASSERT_NE(kind, EventKind::kEscape);
    if (kind == EventKind::kBallPiston) flow.ExchangeComponents();
    // Each repair has an error of a few ulps. 3e4 repairs with errors in one direction give 1e-11.
    ASSERT_LE(EnergyError(flow.state()), 1e-11) << "after " << i << " repairs";
  }
}

TEST(FixedStepFlow, ABallBeyondATipIsLost) {
  const PairGeometry cusps = GeometryOf(0.5001, 0.2);
  FixedStepFlow flow(
      cusps,
      {.position = {0, 0}, .direction = {-1, 0}, .ball_speed = 1, .piston = cusps.piston_right()},
      0.51);
  const Event event = flow.Step();
  EXPECT_EQ(event.kind, EventKind::kEscape);
  EXPECT_EQ(event.duration, 0.51);  // the first step
}

// A ball inside a disc that it leaves, and a ball beyond a piston from which it already comes back:
// both fly straight to a wall.
TEST(FixedStepFlow, OnlyReflectionsAndCollisionsAreEvents) {
  const double rho = kPaperPair.rho();
  const Eigen::Vector2d centre(0.5, 0.5), inward = centre / centre.norm();
  const Eigen::Vector2d beyond(0.15, 0), to_wall = Eigen::Vector2d(-0.5, 0.5) - beyond;
  const PairState leaving = {.position = centre - (rho - 1e-3) * inward,
                             .direction = -inward,
                             .ball_speed = 1,
                             .piston = kPaperPair.piston_right()},
                  parting = {.position = beyond,
                             .direction = to_wall.normalized(),
                             .ball_speed = 1,
                             .piston = 0.13};
  for (const auto& [start, way] :
       {std::pair{leaving, 2 * (centre.norm() - rho)}, std::pair{parting, to_wall.norm() - rho}}) {
    const Event event = FixedStepFlow(kPaperPair, start).Step();
    EXPECT_EQ(event.kind, EventKind::kBallWall);
    EXPECT_NEAR(event.duration, way, 3e-3);
  }
}

// Ball and piston are at their walls after 10.5 steps.
TEST(FixedStepFlow, OnlyTheFirstEventOfAStepTakesTime) {
  const double way = 10.5e-3;
  const Eigen::Vector2d corner = Eigen::Vector2d(-0.5, -0.5), outward = corner / corner.norm();
  FixedStepFlow flow(kPaperPair, {.position = corner - (kPaperPair.rho() + way) * outward,
                                  .direction = outward,
                                  .ball_speed = 1,
                                  .piston = kPaperPair.piston_left() + way,
                                  .piston_velocity = -1});
  const Event ball = flow.Step(), piston = flow.Step();
  EXPECT_EQ(ball.kind, EventKind::kBallWall);
  EXPECT_NEAR(ball.duration, 11e-3, 1e-12);
  EXPECT_EQ(piston.kind, EventKind::kPistonWall);
  EXPECT_EQ(piston.duration, 0);
}

}  // namespace
}  // namespace ballpiston
