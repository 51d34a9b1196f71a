#include "core/gas/trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "core/closed_form/mean_free_time.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/reference_gas.h"
#include "core/geometry/paper.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/geometries.h"

namespace ballpiston {
namespace {

constexpr double kRounding = 1e-12;  // of sums of positions and cells, and of times

PairState PairStart(uint64_t sample) {
  CounterRandom random(23, 0, sample);
  return DrawFromFlowMeasure(kPaperPair, random);
}

GasGeometry Gas(const std::string& shape) {
  return GasGeometry::Create(kPaperRho, 0.15, ParseGasShape(shape).value(), GasEnds::kPeriodic)
      .value();
}

GasState GasStart(const GasGeometry& gas) {
  CounterRandom random(29, 0, 0);
  return DrawGas(gas, TemperatureProfile(1.5), random);
}

TEST(Trace, PairTraceMatchesTheReferenceFlow) {
  const PairState start = PairStart(0);
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

TEST(Trace, GasTraceMatchesTheReferenceGas) {
  for (const char* shape : {"1", "5", "1x1", "4x3"}) {
    const GasGeometry gas = Gas(shape);
    const GasState start = GasStart(gas);
    const auto trace = TraceGas(gas, start);
    ReferenceGas moving(gas, start, ThermalWalls());
    for (int i = 0; i < 5000; ++i) {
      const auto traced = trace->Next();
      const GasEvent event = moving.Step();
      ASSERT_TRUE(traced);
      ASSERT_EQ(traced->kind, event.kind) << shape;
      ASSERT_EQ(traced->time, event.time);
      ASSERT_EQ(traced->ball ? traced->ball->index : -1, event.ball);
      ASSERT_EQ(traced->piston ? traced->piston->index : -1, event.piston);
      if (traced->ball) {
        ASSERT_EQ(traced->ball->after.energy, moving.BallEnergy(event.ball));
        const Eigen::Vector2d cell(static_cast<double>(event.ball % gas.shape().columns),
                                   static_cast<double>(event.ball / gas.shape().columns));
        ASSERT_TRUE(InsideCell(gas.pair(), traced->ball->after.position - cell, kRounding));
      }
      if (traced->piston) {
        ASSERT_EQ(traced->piston->after.energy, moving.PistonEnergy(event.piston));
      }
    }
  }
}

// The pistons of a cell are on its four sides, up to the periodic boundary.
TEST(Trace, BallAndPistonExchangeAtTheSamePlace) {
  const GasGeometry gas = Gas("4x3");
  const auto trace = TraceGas(gas, GasStart(gas));
  for (int exchanges = 0; exchanges < 1000;) {
    const auto event = trace->Next();
    if (event->kind != EventKind::kBallPiston) continue;
    ++exchanges;
    const int axis = gas.IsAlongX(event->piston->index) ? 0 : 1;
    const double cells = axis == 0 ? 4 : 3;
    const double distance = event->ball->after.position[axis] - event->piston->after.position[axis];
    ASSERT_NEAR(std::remainder(distance, cells), 0, kRounding);
    ASSERT_EQ(event->piston->after.velocity[1 - axis], 0);
  }
}

double EnergyOfAll(const Trace& trace) {
  double sum = 0;
  for (const TracedBody& ball : trace.Balls()) sum += ball.energy;
  for (const TracedBody& piston : trace.Pistons()) sum += piston.energy;
  return sum;
}

double EnergyGain(const TraceEvent& event) {
  double gain = 0;
  if (event.ball) gain += event.ball->after.energy - event.ball->energy_before;
  if (event.piston) gain += event.piston->after.energy - event.piston->energy_before;
  return gain;
}

TEST(Trace, EveryEventConservesEnergy) {
  const GasGeometry gas = Gas("4x3");
  const auto pair = TracePair(kPaperPair, PairStart(1));
  const auto lattice = TraceGas(gas, GasStart(gas));
  EXPECT_NEAR(EnergyOfAll(*pair), 0.5, 1e-15);
  for (const auto& trace : {pair.get(), lattice.get()}) {
    const double energy = EnergyOfAll(*trace);
    for (int i = 0; i < 10'000; ++i) {
      const auto event = trace->Next();
      ASSERT_NEAR(EnergyGain(*event), 0, 1e-14 * energy);
      if (event->kind != EventKind::kBallPiston) {
        ASSERT_EQ(EnergyGain(*event), 0);
      }
      for (const auto& change : {event->ball, event->piston}) {
        if (!change) continue;
        ASSERT_NEAR(change->after.velocity.squaredNorm() / 2, change->after.energy, 1e-14 * energy);
      }
    }
  }
}

// Also checks that the energy before an event is that after the previous event.
TEST(Trace, BodiesFlyStraightBetweenTheirEvents) {
  const GasGeometry gas = Gas("4x3");
  const auto trace = TraceGas(gas, GasStart(gas));
  using Flight = std::pair<double, TracedBody>;  // since
  std::map<std::pair<bool, int64_t>, Flight> flights;
  for (const TracedBody& ball : trace->Balls()) {
    flights[{true, static_cast<int64_t>(flights.size())}] = {0, ball};
  }
  for (const TracedBody& piston : trace->Pistons()) {
    flights[{false, static_cast<int64_t>(flights.size()) - gas.balls()}] = {0, piston};
  }
  for (int i = 0; i < 5000; ++i) {
    const auto event = trace->Next();
    for (const bool is_ball : {true, false}) {
      const auto& change = is_ball ? event->ball : event->piston;
      if (!change) continue;
      Flight& flight = flights.at({is_ball, change->index});
      const Eigen::Vector2d expected =
          flight.second.position + (event->time - flight.first) * flight.second.velocity;
      ASSERT_LT((change->after.position - expected).norm(), kRounding);
      ASSERT_EQ(change->energy_before, flight.second.energy);
      flight = {event->time, change->after};
    }
  }
}

TEST(Trace, FreeTimesCountFromTheSameKindAndBodies) {
  const GasGeometry gas = Gas("4x3");
  const auto trace = TraceGas(gas, GasStart(gas));
  std::map<std::tuple<EventKind, int64_t, int64_t>, double> last;
  for (int i = 0; i < 5000; ++i) {
    const auto event = trace->Next();
    const auto [place, is_first] =
        last.try_emplace({event->kind, event->ball ? event->ball->index : -1,
                          event->piston ? event->piston->index : -1},
                         event->time);
    ASSERT_EQ(event->free_time.has_value(), !is_first);
    if (event->free_time) {
      ASSERT_EQ(*event->free_time, event->time - place->second);
    }
    place->second = event->time;
  }
}

struct Mean {
  double sum = 0;
  int count = 0;
};

std::map<EventKind, Mean> MeanFreeTimesOf(Trace& trace, int events) {
  std::map<EventKind, Mean> means;
  for (int i = 0; i < events; ++i) {
    const auto event = trace.Next();
    if (!event->free_time) continue;
    means[event->kind].sum += *event->free_time;
    ++means[event->kind].count;
  }
  return means;
}

// Tolerances of a million events, relative: five times the root mean square error over 20 seeds.
TEST(Trace, FreeTimesHaveTheMeansOfTheClosedForms) {
  const auto pair = TracePair(kPaperPair, PairStart(2));
  const auto times = MeanFreeTimesOf(*pair, 1'000'000);
  const auto expect = [&](EventKind kind, double expected, double tolerance) {
    EXPECT_NEAR(times.at(kind).sum / times.at(kind).count, expected, tolerance * expected);
  };
  const ballpiston::MeanFreeTimes exact = MeanFreeTimesFrom(Measures(kPaperPair));
  expect(EventKind::kBallPiston, exact.ball_piston, 0.036);
  expect(EventKind::kBallWall, exact.ball_wall, 0.014);
  expect(EventKind::kPistonWall, exact.piston_wall, 0.028);
}

// The orbit keeps its energy E, and the rate grows as its root: the canonical rate at temperature 1
// is the mean over E, whose law is Gamma(n), 2 n degrees of freedom.
TEST(Trace, ExchangesOfAGasHaveItsExchangeRate) {
  const GasGeometry gas = Gas("3x3");
  constexpr double kHalfOfFreedom = 9 + 18 / 2.0;
  const double mean_root =
      std::exp(std::lgamma(kHalfOfFreedom + 0.5) - std::lgamma(kHalfOfFreedom));
  const auto trace = TraceGas(gas, GasStart(gas));
  const double rate = GasExchangeRate(gas, 1) * std::sqrt(EnergyOfAll(*trace)) / mean_root;
  const Mean exchanges = MeanFreeTimesOf(*trace, 1'000'000).at(EventKind::kBallPiston);
  EXPECT_NEAR(exchanges.sum / exchanges.count * rate, 1, 0.028);
}

}  // namespace
}  // namespace ballpiston
