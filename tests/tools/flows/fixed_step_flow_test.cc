#include "tools/flows/fixed_step_flow.h"

#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

TEST(FixedStepFlow, EnergyStaysExact) {
  CounterRandom random(3, 0, 0);
  FixedStepFlow flow(kPaperPair, DrawFromFlowMeasure(kPaperPair, random), 1e-3);
  for (int i = 0; i < 30'000; ++i) {
    const FixedSteps done = flow.Advance(1000);
    ASSERT_FALSE(done.lost);
    if (done.ball_piston) flow.ExchangeComponents();
    // Each repair has an error of a few ulps. 3e4 repairs with errors in one direction give 1e-11.
    ASSERT_LE(EnergyError(flow.state()), 1e-11) << "after " << i << " repairs";
  }
}

TEST(FixedStepFlow, ABallInADiscIsPushedOutAndReflected) {
  const double rho = kPaperPair.rho(), at_wall = 0.5 - rho * M_SQRT1_2;
  FixedStepFlow flow(kPaperPair,
                     {.position = {at_wall - 0.01, at_wall - 0.01},
                      .direction = {M_SQRT1_2, M_SQRT1_2},
                      .ball_speed = 1,
                      .piston = kPaperPair.piston_right()},
                     0.02);
  const FixedSteps done = flow.Advance(1);
  EXPECT_TRUE(done.ball_wall);
  EXPECT_NEAR((flow.state().position - Eigen::Vector2d(at_wall, at_wall)).norm(), 0, 1e-15);
  EXPECT_NEAR((flow.state().direction + Eigen::Vector2d(M_SQRT1_2, M_SQRT1_2)).norm(), 0, 1e-15);
}

TEST(FixedStepFlow, APistonBeyondItsWallIsFoldedBack) {
  FixedStepFlow flow(kPaperPair,
                     {.ball_speed = 0, .piston = kPaperPair.piston_right(), .piston_velocity = 1},
                     0.01);
  EXPECT_TRUE(flow.Advance(1).piston_wall);
  EXPECT_DOUBLE_EQ(flow.state().piston, kPaperPair.piston_right() - 0.01);
  EXPECT_EQ(flow.state().piston_velocity, -1);
}

TEST(FixedStepFlow, ABallThatHasPassedThePistonCollides) {
  FixedStepFlow flow(
      kPaperPair, {.position = {0.1, 0}, .ball_speed = 0.8, .piston = 0.2, .piston_velocity = -0.6},
      0.02);
  const FixedSteps done = flow.Advance(1000);
  EXPECT_TRUE(done.ball_piston);
  EXPECT_EQ(done.steps, 4);  // they collide at time 0.1/1.4, after 3.6 steps
  flow.ExchangeComponents();
  EXPECT_DOUBLE_EQ(flow.state().ball_speed, 0.6);
  EXPECT_EQ(flow.state().direction.x(), -1);
  EXPECT_DOUBLE_EQ(flow.state().piston_velocity, 0.8);
  EXPECT_EQ(flow.state().position.x(), flow.state().piston);
}

TEST(FixedStepFlow, ABallBeyondATipIsLost) {
  const PairGeometry cusps = GeometryOf(0.5001, 0.2);
  FixedStepFlow flow(
      cusps,
      {.position = {0, 0}, .direction = {-1, 0}, .ball_speed = 1, .piston = cusps.piston_right()},
      0.51);
  EXPECT_TRUE(flow.Advance(1).lost);
}

}  // namespace
}  // namespace ballpiston
