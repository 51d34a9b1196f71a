#include "core/gas/trace.h"

#include "core/gas/reference_gas.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

constexpr double kRounding = 1e-12;  // of sums of positions and cells, and of times

TEST(Trace, PairTraceMatchesTheReferenceFlow) {
  CounterRandom random(23, 0, 0);
  const PairState start = DrawFromFlowMeasure(kPaperPair, random);
  const auto trace = TracePair(kPaperPair, start);
  ReferenceFlow flow(kPaperPair, start);
  EXPECT_EQ(trace->Balls().at(0).position, start.position);
  EXPECT_EQ(trace->Pistons().at(0).position, Eigen::Vector2d(start.piston, 0));
  double time = 0;
  for (int i = 0; i < 10'000; ++i) {
    const auto traced = trace->Next();
    const Event event = flow.Step();
    if (event.kind == EventKind::kBallPiston) flow.ExchangeComponents();
    time += event.duration;
    ASSERT_TRUE(traced);
    ASSERT_EQ(traced->kind, event.kind);
    ASSERT_EQ(traced->time, time);
    ASSERT_EQ(traced->ball.has_value(), event.kind != EventKind::kPistonWall);
    ASSERT_EQ(traced->piston.has_value(), event.kind != EventKind::kBallWall);
    const PairState& state = flow.state();
    if (traced->ball) {
      ASSERT_EQ(traced->ball->after.position, state.position);
      ASSERT_EQ(traced->ball->after.velocity, state.ball_speed * state.direction);
    }
    if (traced->piston) {
      ASSERT_EQ(traced->piston->after.position.x(), state.piston);
      ASSERT_EQ(traced->piston->after.velocity.x(), state.piston_velocity);
    }
  }
}

double EnergyGain(const TraceEvent& event) {
  double gain = 0;
  if (event.ball) gain += event.ball->after.energy - event.ball->energy_before;
  if (event.piston) gain += event.piston->after.energy - event.piston->energy_before;
  return gain;
}

// The pistons of a cell are on its four sides, up to the periodic boundary.
void ExpectAtTheSamePlace(const GasGeometry& gas, const TraceEvent& event) {
  const int axis = gas.IsAlongX(event.piston->index) ? 0 : 1;
  const auto cells = static_cast<double>(axis == 0 ? gas.shape().columns : gas.shape().rows);
  const double distance = event.ball->after.position[axis] - event.piston->after.position[axis];
  EXPECT_NEAR(std::remainder(distance, cells), 0, kRounding);
  EXPECT_EQ(event.piston->after.velocity[1 - axis], 0);
}

void ExpectSameEvent(const GasGeometry& gas, const std::optional<TraceEvent>& traced,
                     const GasEvent& expected) {
  ASSERT_TRUE(traced);
  ASSERT_EQ(traced->kind, expected.kind);
  ASSERT_EQ(traced->time, expected.time);
  ASSERT_EQ(traced->ball ? traced->ball->index : -1, expected.ball);
  ASSERT_EQ(traced->piston ? traced->piston->index : -1, expected.piston);
  if (traced->ball) {
    const TracedBody& ball = traced->ball->after;
    if (traced->piston) {
      ASSERT_EQ(ball.energy, expected.ball_energy);
    }
    const Eigen::Vector2d cell(static_cast<double>(expected.ball % gas.shape().columns),
                               static_cast<double>(expected.ball / gas.shape().columns));
    ASSERT_TRUE(InsideCell(gas.pair(), ball.position - cell, kRounding));
  }
  if (traced->piston) {
    ASSERT_EQ(traced->piston->after.energy, expected.piston_energy);
  }
}

// A body's energy before an event is that after its previous event. A free time counts from the
// last event of the same kind and bodies, on the same side of the ball.
void ExpectEventsOfTheReferenceAndStraightFlights(const GasGeometry& gas) {
  const GasState start = GasInEquilibrium(gas, 1.5, 29, 0);
  const auto trace = TraceGas(gas, start);
  ReferenceGas moving(gas, start, ThermalWalls());
  using Flight = std::pair<double, TracedBody>;  // since
  std::map<std::pair<bool, int64_t>, Flight> flights;
  double energy = 0;
  for (const bool is_ball : {true, false}) {
    for (const TracedBody& body : is_ball ? trace->Balls() : trace->Pistons()) {
      const int64_t index = static_cast<int64_t>(flights.size()) - (is_ball ? 0 : gas.balls());
      flights[{is_ball, index}] = {0, body};
      energy += body.energy;
    }
  }
  std::map<std::tuple<EventKind, int64_t, int64_t, Direction>, double> last;
  for (int i = 0; i < 10'000; ++i) {
    const auto event = trace->Next();
    const GasEvent expected = moving.Step();
    ASSERT_NO_FATAL_FAILURE(ExpectSameEvent(gas, event, expected));
    const bool is_exchange = event->kind == EventKind::kBallPiston;
    ASSERT_NEAR(EnergyGain(*event), 0, is_exchange ? 1e-14 * energy : 0);
    if (is_exchange) ExpectAtTheSamePlace(gas, *event);
    for (const bool is_ball : {true, false}) {
      const auto& change = is_ball ? event->ball : event->piston;
      if (!change) continue;
      auto& [since, body] = flights.at({is_ball, change->index});
      const Eigen::Vector2d straight = body.position + (event->time - since) * body.velocity;
      ASSERT_LT((change->after.position - straight).norm(), kRounding);
      ASSERT_EQ(change->energy_before, body.energy);
      ASSERT_NEAR(change->after.velocity.squaredNorm() / 2, change->after.energy, 1e-14 * energy);
      since = event->time;
      body = change->after;
    }
    const auto [place, is_first] = last.try_emplace(
        {expected.kind, expected.ball, expected.piston, expected.direction}, event->time);
    ASSERT_EQ(event->free_time.has_value(), !is_first);
    if (!is_first) {
      ASSERT_EQ(*event->free_time, event->time - place->second);
    }
    place->second = event->time;
  }
}

TEST(Trace, EventsAreThoseOfTheReferenceAndEndStraightFlights) {
  for (const char* shape : {"1", "5", "1x1", "4x3"}) {
    SCOPED_TRACE(shape);
    ExpectEventsOfTheReferenceAndStraightFlights(GasOf(kPaperRho, 0.15, shape));
  }
}

}  // namespace
}  // namespace ballpiston
