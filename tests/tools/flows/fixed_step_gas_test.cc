#include "tools/flows/fixed_step_gas.h"

#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

double EnergyNow(const FixedStepGas& gas, const GasGeometry& geometry) {
  double sum = 0;
  for (int64_t i = 0; i < geometry.balls(); ++i) sum += EnergyOf(gas.BallNow(i));
  for (int64_t i = 0; i < geometry.pistons(); ++i) sum += EnergyOf(gas.PistonNow(i));
  return sum;
}

int CountOf(EventKind kind, const std::vector<GasEvent>& events) {
  int count = 0;
  for (const GasEvent& event : events) count += event.kind == kind;
  return count;
}

// Each repair has an error of a few ulps; there are about 1e4 repairs.
TEST(FixedStepGas, KeepsItsEnergy) {
  for (const char* shape : {"1", "3", "1x1", "3x2"}) {
    const GasGeometry geometry = GasOf(kPaperRho, 0.2, shape);
    const GasState start = GasInEquilibrium(geometry, 1, 81, 0);
    FixedStepGas gas(geometry, start, ThermalWalls(), 1e-3);
    int exchanges = 0, escapes = 0;
    while (gas.time() < 200) {
      const std::vector<GasEvent>& events = gas.Advance();
      exchanges += CountOf(EventKind::kBallPiston, events);
      escapes += CountOf(EventKind::kEscape, events);
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
    GasState state;
    state.balls.resize(9);
    state.pistons.resize(18);
    const double sign = SignOf(direction);
    const int64_t piston = geometry.PistonOf(4, direction);
    state.balls[4] = {.position = SeenFrom(direction, {0.1, 0}),
                      .direction = SeenFrom(direction, {1, 0}),
                      .speed = 0.8};
    state.pistons[static_cast<size_t>(piston)] = {.offset = -0.3 * sign, .velocity = -0.6 * sign};
    FixedStepGas gas(geometry, state, ThermalWalls(), 0.02);
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(gas.Advance().empty());
    const std::vector<GasEvent> events = gas.Advance();
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0].kind, EventKind::kBallPiston);
    EXPECT_EQ(events[0].ball, 4);
    EXPECT_EQ(events[0].piston, piston);
    EXPECT_EQ(events[0].direction, direction);
    EXPECT_DOUBLE_EQ(events[0].time, 0.08);
    const GasBall ball = gas.BallNow(4);
    EXPECT_DOUBLE_EQ(ball.speed, 0.6);
    EXPECT_EQ(SeenToward(direction, ball.direction).x(), -1);
    EXPECT_DOUBLE_EQ(gas.PistonNow(piston).velocity, 0.8 * sign);
  }
}

TEST(FixedStepGas, ALostBallStops) {
  const GasGeometry cusps = GasOf(0.5001, 0.2, "2");
  GasState state;
  state.balls = {{.position = {0, 0}, .direction = {1, 0}, .speed = 1}, {}};
  state.pistons = {{.offset = cusps.reach()}, {.offset = cusps.reach()}};
  FixedStepGas gas(cusps, state, ThermalWalls(), 0.51);
  EXPECT_EQ(CountOf(EventKind::kEscape, gas.Advance()), 1);
  const double x = gas.BallNow(0).position.x();
  EXPECT_TRUE(gas.Advance().empty());
  EXPECT_EQ(gas.BallNow(0).position.x(), x);
}

}  // namespace
}  // namespace ballpiston
