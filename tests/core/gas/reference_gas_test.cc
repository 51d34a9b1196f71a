#include "core/gas/reference_gas.h"

#include "core/billiard/event_flow.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

ReferenceGas GasFrom(const GasGeometry& geometry, const GasState& state) {
  return ReferenceGas(geometry, state, ThermalWalls());
}

// A pair in the place of a ball and the piston that it sees in the direction, `speed` times as
// fast.
GasState WithPair(const GasGeometry& gas, const PairState& pair, double speed, int64_t ball,
                  Direction direction) {
  GasState state = AtRest(gas);
  state.balls[static_cast<size_t>(ball)] = {.position = SeenFrom(direction, pair.position),
                                            .direction = SeenFrom(direction, pair.direction),
                                            .speed = speed * pair.ball_speed};
  const double sign = SignOf(direction);
  state.pistons[static_cast<size_t>(gas.PistonOf(ball, direction))] = {
      .offset = sign * (pair.piston - 0.5), .velocity = sign * speed * pair.piston_velocity};
  return state;
}

// From equilibrium; a ball that flies into a piston at rest; and balls at rest within the piston's
// reach, the last one at the end of its stroke, so that the piston comes no nearer. Off the axis,
// so that no ball flies into a tip.
std::vector<PairState> PairStarts(const PairGeometry& pair) {
  std::vector<PairState> starts = {
      {.position = {0, 0.03}, .direction = {1, 0}, .ball_speed = 1, .piston = 0.2},
      {.position = {0.2, 0.03}, .direction = {0, 1}, .piston = 0.25, .piston_velocity = 1},
      {.position = {pair.piston_left(), 0.03},
       .direction = {1, 0},
       .piston = 0.5,
       .piston_velocity = -1}};
  for (uint64_t sample = 0; sample < 100; ++sample) {
    CounterRandom random(71, 0, sample);
    starts.push_back(DrawFromFlowMeasure(pair, random));
  }
  return starts;
}

// All other bodies rest: balls in the middle of their cells, pistons on their edges, which no ball
// reaches. An error of 1e-16 grows about threefold a wall hit, to 1e-9 in 15 hits.
TEST(ReferenceGas, OneBallAndOnePistonMoveLikeThePair) {
  constexpr double kSpeed = 3.7, kTolerance = 1e-8;
  constexpr int kWallHits = 15;
  int exchanges = 0;
  for (const auto& [direction, shape] : {std::pair(Direction::kRight, "1x1"),
                                         {Direction::kRight, "3x3"},
                                         {Direction::kUp, "3x3"},
                                         {Direction::kLeft, "3x3"},
                                         {Direction::kDown, "3x3"},
                                         {Direction::kUp, "2x1"},
                                         {Direction::kLeft, "2x1"}}) {
    const GasGeometry gas = GasOf(kPaperRho, 0.2, shape);
    const std::vector<PairState> starts = PairStarts(gas.pair());
    for (size_t i = 0; i < starts.size(); ++i) {
      SCOPED_TRACE(testing::Message() << "direction " << static_cast<int>(direction) << " shape "
                                      << shape << " start " << i);
      const int64_t ball = static_cast<int64_t>(i) % gas.balls();
      // In a cell that is its own neighbour the piston comes from the other side as well.
      const bool is_alone = shape[IsAlongX(direction) ? 0 : 2] != '1';
      ReferenceFlow flow(gas.pair(), starts[i]);
      ReferenceGas moving = GasFrom(gas, WithPair(gas, starts[i], kSpeed, ball, direction));
      double time = 0;
      for (int wall_hits = 0; wall_hits < kWallHits;) {
        const Event expected = flow.Step();
        time += expected.duration;
        const GasEvent event = moving.Step();
        const bool is_exchange = event.kind == EventKind::kBallPiston;
        if (!is_alone && is_exchange && event.direction != direction) break;
        ASSERT_EQ(event.kind, expected.kind);
        ASSERT_NEAR(event.time * kSpeed, time, kTolerance * (1 + time));
        if (is_exchange) {
          ++exchanges;
          flow.ExchangeComponents();
          ASSERT_EQ(event.direction, direction);
          ASSERT_EQ(event.ball, ball);
          ASSERT_EQ(event.piston, gas.PistonOf(ball, direction));
        }
        wall_hits += event.kind == EventKind::kBallWall;
        const GasState pair = WithPair(gas, flow.state(), kSpeed, ball, direction);
        const Eigen::VectorXd difference =
            ComponentsOf(moving.StateAt(event.time)) - ComponentsOf(pair);
        ASSERT_LE(difference.cwiseAbs().maxCoeff(), kTolerance);
      }
    }
  }
  EXPECT_GT(exchanges, 200);
}

// Slacks: an ulp of a place in a cell, some more where two discs are nearly tangent, as in
// reference_flow_test.cc. A place is that of the last event moved on, which rounds again. The runs
// are long enough for the origin of time to move: it moves after every 1024 events for each body.
TEST(ReferenceGas, BallsStayInTheirCellsAndBeforeTheirPistons) {
  constexpr double kSlack = 1e-13;
  for (const double rho : {0.5 + 1e-9, 0.501, kPaperRho, 0.6, 0.7}) {
    for (const char* shape : {"1", "3", "1x1", "3x2"}) {
      for (const GasEnds ends : {GasEnds::kPeriodic, GasEnds::kReservoirs}) {
        const GasGeometry gas = GasAtShare(rho, 1, shape, ends);
        SCOPED_TRACE(testing::Message() << "rho " << rho << " shape " << shape);
        const GasRandom random(74, 0, 0);
        ReferenceGas moving(gas, GasInEquilibrium(gas, 1, 74, 0), ThermalWalls(gas, 2, 1, random));
        double last = 0;
        for (int i = 0; i < 20'000; ++i) {
          const GasEvent event = moving.Step();
          ASSERT_NE(event.kind, EventKind::kEscape) << i;
          ASSERT_GE(event.time, last - kSlack) << i;
          last = event.time;
          if (moving.NextTime() < last)
            continue;  // rounding: the next event is at the same instant
          const GasState state = moving.StateAt(last);
          for (int64_t ball = 0; ball < gas.balls(); ++ball) {
            const GasBall& here = state.balls[static_cast<size_t>(ball)];
            ASSERT_TRUE(InsideCell(gas.pair(), here.position, kSlack)) << "event " << i;
            ASSERT_NEAR(here.direction.norm(), 1, 1e-15);
            for (int k = 0; k < gas.directions(); ++k) {
              ASSERT_GE(GapTo(gas, state, ball, gas.DirectionAt(k)), -kSlack) << "event " << i;
            }
          }
        }
      }
    }
  }
}

// A piston that meets no ball turns after equal times. Each turn rounds the time, always by the
// same amount: a million turns, by 4e-11 each at the end, would add up to 1e-5.
TEST(ReferenceGas, LongRunsKeepTheDigitsOfTheirTimes) {
  constexpr int kTurns = 1'000'000;
  const GasGeometry gas = GasOf(kPaperRho, 0.15, "1");
  GasState state = AtRest(gas);
  state.pistons[0] = {.offset = -gas.reach(), .velocity = 1};
  ReferenceGas moving = GasFrom(gas, state);
  double time = 0;
  for (int i = 0; i < kTurns; ++i) time = moving.Step().time;
  EXPECT_NEAR(time, kTurns * 2 * gas.reach(), 5e-8);
  EXPECT_EQ(std::fabs(moving.PistonAt(0, time).offset), gas.reach());
}

// A ball beyond a tip, where no disc is ahead of it. The piston there goes away from the ball at
// first, and would meet it again and again after it has turned.
TEST(ReferenceGas, AnEscapedBallStopsAndCountsOnce) {
  const GasGeometry gas = GasOf(kPaperRho, 0.2, "3");
  GasState state = AtRest(gas);
  state.balls[1] = {.position = {0.6, 0}, .direction = {1, 0}, .speed = 1};
  state.pistons[static_cast<size_t>(gas.PistonOf(1, Direction::kRight))].velocity = 2;
  ReferenceGas moving = GasFrom(gas, state);
  EXPECT_EQ(moving.Step().kind, EventKind::kEscape);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(moving.Step().kind, EventKind::kPistonWall) << i;
  const GasBall ball = moving.BallAt(1, moving.NextTime());
  EXPECT_EQ(ball.speed, 0);
  EXPECT_TRUE(InsideCell(gas.pair(), ball.position, 0));
}

TEST(ReferenceGas, AGasAtRestHasAnInfiniteNextTime) {
  const GasGeometry gas = GasOf(kPaperRho, 0.2, "2x2");
  EXPECT_EQ(GasFrom(gas, AtRest(gas)).NextTime(), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace ballpiston
