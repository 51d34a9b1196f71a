#include "tools/flows/fixed_step_flow.h"

#include "core/sampling/invariant_measure.h"
#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"
#include "tools/flows/fixed_step_gas.h"

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

// ---- fixed_step_gas.h ----

double EnergyNow(const FixedStepGas& gas, const GasGeometry& geometry) {
  double sum = 0;
  for (int64_t i = 0; i < geometry.balls(); ++i) sum += EnergyOf(gas.BallAt(i, 0));
  for (int64_t i = 0; i < geometry.pistons(); ++i) sum += EnergyOf(gas.PistonAt(i, 0));
  return sum;
}

// Each repair has an error of a few ulps; there are about 1e4 repairs.
TEST(FixedStepGas, KeepsItsEnergy) {
  for (const char* shape : {"1", "3", "1x1", "3x2"}) {
    const GasGeometry geometry = GasOf(kPaperRho, 0.2, shape);
    const GasState start = GasInEquilibrium(geometry, 1, 81, 0);
    FixedStepGas gas(geometry, start, ThermalWalls(), 1e-3);
    int exchanges = 0, escapes = 0;
    while (gas.NextTime() < 200) {
      const EventKind kind = gas.Step().kind;
      exchanges += kind == EventKind::kBallPiston;
      escapes += kind == EventKind::kEscape;
    }
    EXPECT_GT(exchanges, 10) << shape;
    EXPECT_EQ(escapes, 0) << shape;
    EXPECT_NEAR(EnergyNow(gas, geometry) / EnergyOf(start), 1, 1e-11) << shape;
  }
}

// Ball and piston collide after 3.6 steps, on the cell's axis.
TEST(FixedStepGas, ABallThatHasPassedAPistonExchanges) {
  const GasGeometry geometry = GasOf(kPaperRho, 0.2, "3x3");
  for (const Direction direction :
       {Direction::kRight, Direction::kUp, Direction::kLeft, Direction::kDown}) {
    GasState state = AtRest(geometry);
    const double sign = SignOf(direction);
    const int64_t piston = geometry.PistonOf(4, direction);
    state.balls[4] = {.position = SeenFrom(direction, {0.1, 0}),
                      .direction = SeenFrom(direction, {1, 0}),
                      .speed = 0.8};
    state.pistons[static_cast<size_t>(piston)] = {.offset = -0.3 * sign, .velocity = -0.6 * sign};
    FixedStepGas gas(geometry, state, ThermalWalls(), 0.02);
    EXPECT_DOUBLE_EQ(gas.NextTime(), 0.08);
    const GasEvent event = gas.Step();
    EXPECT_EQ(event.kind, EventKind::kBallPiston);
    EXPECT_EQ(event.ball, 4);
    EXPECT_EQ(event.piston, piston);
    EXPECT_EQ(event.direction, direction);
    EXPECT_DOUBLE_EQ(event.ball_energy, 0.6 * 0.6 / 2);
    EXPECT_DOUBLE_EQ(event.piston_energy, 0.8 * 0.8 / 2);
    EXPECT_DOUBLE_EQ(event.time, 0.08);
    const GasBall ball = gas.BallAt(4, event.time);
    EXPECT_DOUBLE_EQ(ball.speed, 0.6);
    EXPECT_EQ(SeenToward(direction, ball.direction).x(), -1);
    EXPECT_DOUBLE_EQ(gas.PistonAt(piston, event.time).velocity, 0.8 * sign);
  }
}

TEST(FixedStepGas, ALostBallStops) {
  const GasGeometry cusps = GasOf(0.5001, 0.2, "2");
  GasState state;
  state.balls = {{.position = {0, 0}, .direction = {1, 0}, .speed = 1}, {}};
  state.pistons = {{.offset = cusps.reach()}, {.offset = cusps.reach()}};
  FixedStepGas gas(cusps, state, ThermalWalls(), 0.51);
  const GasEvent event = gas.Step();
  EXPECT_EQ(event.kind, EventKind::kEscape);
  const double x = gas.BallAt(0, event.time).position.x();
  EXPECT_EQ(gas.NextTime(), std::numeric_limits<double>::infinity());
  EXPECT_EQ(gas.BallAt(0, event.time).position.x(), x);
}

}  // namespace
}  // namespace ballpiston
