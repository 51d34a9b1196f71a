#include "core/gas/lane_gas.h"

#include "core/closed_form/pair_measures.h"
#include "core/gas/gas_exchange_rate.h"
#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// The energies of all bodies of some replicas at a time, and the number of their exchanges.
struct Outcome {
  std::vector<double> energies;
  uint64_t exchanges = 0;
  uint64_t escapes = 0;
};

Outcome OutcomeOf(GasEngine engine, const GasGeometry& geometry, uint64_t replicas, double time,
                  double hot = 1, double cold = 1) {
  std::vector<GasStart> starts;
  for (uint64_t i = 0; i < replicas; ++i) {
    const GasRandom random(41, 0, i);
    starts.push_back(
        {GasInEquilibrium(geometry, 1, 42, i), ThermalWalls(geometry, hot, cold, random), random});
  }
  const auto gases = StartGases(engine, geometry, GasExchangeRate(geometry, 1), std::move(starts));
  gases->AdvanceTo(time);
  Outcome outcome;
  for (const GasMeter& meter : gases->meters()) {
    for (size_t body = 0; body < meter.bodies(); ++body) {
      outcome.energies.push_back(meter.Energy(body));
    }
    outcome.exchanges += meter.exchanges();
    outcome.escapes += meter.escapes();
  }
  return outcome;
}

// Errors of some ulps grow threefold with each wall hit, and faster at grazing hits. So some fast
// balls may differ. A missed exchange would change the count.
void ExpectSame(const Outcome& lanes, const Outcome& reference) {
  EXPECT_EQ(lanes.exchanges, reference.exchanges);
  EXPECT_EQ(lanes.escapes, 0u);
  size_t off = 0;
  for (size_t i = 0; i < lanes.energies.size(); ++i) {
    off += std::fabs(lanes.energies[i] - reference.energies[i]) > 1e-7;
  }
  EXPECT_LE(off, 2 + lanes.energies.size() / 100);
}

// Some four wall hits of a ball; between thermal walls some more.
TEST(LaneGas, AgreesWithTheReferenceEventByEvent) {
  const auto expect_same = [](const GasGeometry& gas, double time, double hot, double cold) {
    ExpectSame(OutcomeOf(GasEngine::kLanes, gas, 100, time, hot, cold),
               OutcomeOf(GasEngine::kReference, gas, 100, time, hot, cold));
  };
  for (const double rho : {0.502, kPaperRho, 0.69}) {
    for (const double share : {1.0, 0.5, 0.1}) {
      for (const char* shape : {"1", "2", "5", "1x1", "2x1", "3x3"}) {
        SCOPED_TRACE(testing::Message() << shape << " rho " << rho << " share " << share);
        const GasGeometry gas = GasAtShare(rho, share, shape);
        expect_same(gas, 4 * gas.pair().tip(), 1, 1);
      }
    }
  }
  for (const char* shape : {"1", "3", "2x2"}) {
    SCOPED_TRACE(shape);
    expect_same(GasAtShare(kPaperRho, 0.8, shape, GasEnds::kReservoirs), 2, 3, 0.5);
  }
}

// Balls rest in the middle of their cells, where no piston comes. So each piston moves back and
// forth between its walls. Meanwhile the time origin moves about twenty times.
TEST(LaneGas, PistonsKeepTheirMotionWhenTheOriginMoves) {
  constexpr double kTime = 5000;
  const GasGeometry gas = GasOf(kPaperRho, 0.15, "2x2");
  GasState start = GasInEquilibrium(gas, 1, 46, 0);
  for (GasBall& ball : start.balls) ball = {};
  const auto run = StartGases(GasEngine::kLanes, gas, GasExchangeRate(gas, 1),
                              {{start, ThermalWalls(), GasRandom(46, 0, 0)}});
  run->AdvanceTo(kTime);
  const GasState state = run->StateOf(0);
  for (size_t i = 0; i < state.pistons.size(); ++i) {
    const auto& [offset, velocity] = start.pistons[i];
    const double stroke = 2 * gas.reach();
    const double way = velocity > 0 ? offset + gas.reach() : stroke + gas.reach() - offset;
    const double phase = std::fmod(way + std::fabs(velocity) * kTime, 2 * stroke);
    const bool is_forth = phase < stroke;
    EXPECT_NEAR(state.pistons[i].offset, (is_forth ? phase : 2 * stroke - phase) - gas.reach(),
                1e-9);
    EXPECT_EQ(state.pistons[i].velocity, is_forth ? std::fabs(velocity) : -std::fabs(velocity));
  }
}

std::unique_ptr<GasRun> InLanes(const GasGeometry& gas, const GasState& state) {
  const GasRandom random(45, 0, 0);
  return StartGases(GasEngine::kLanes, gas, GasExchangeRate(gas, 1),
                    {{state, ThermalWalls(gas, 1, 1, random), random}});
}

// The piston moves ahead of the ball. Both reach the tip at the same time, to within some ulps.
// There the walls and the piston are closer to the ball than its rounding; the ball must stay in
// the cell. Returns the number of exchanges.
uint64_t MeetInTheTip(const GasGeometry& gas, CounterRandom& random) {
  constexpr double kWay = 0.01;
  const double slope = gas.pair().lambda() * (2 * random.Uniform() - 1);
  const double speed = random.Uniform(), off = 1e-15 * (random.Uniform() - 0.5);
  const Eigen::Vector2d direction = Eigen::Vector2d(1, slope).normalized();
  const Eigen::Vector2d tip = {gas.pair().tip(), 0};
  GasState state = AtRest(gas);
  state.balls = {{.position = tip - kWay * direction, .direction = direction, .speed = 1}};
  state.pistons[0] = {.offset = tip.x() - kWay * speed * direction.x() - 0.5 + off,
                      .velocity = speed * direction.x()};
  const auto gases = InLanes(gas, state);
  gases->AdvanceTo(1);
  const GasMeter& meter = gases->meters().front();
  EXPECT_EQ(meter.escapes(), 0u);
  EXPECT_NEAR(meter.TotalEnergy(), EnergyOf(state), 1e-14);
  return meter.exchanges();
}

TEST(LaneGas, BallsThatMeetPistonsInTipsStayInTheirCells) {
  for (const double rho : {0.501, 0.6, 0.69}) {
    for (const char* shape : {"1", "1x1"}) {
      const GasGeometry gas = GasAtShare(rho, 1, shape);
      uint64_t exchanges = 0;
      for (uint64_t i = 0; i < 2000; ++i) {
        SCOPED_TRACE(testing::Message() << "rho " << rho << ", " << shape << ", start " << i);
        CounterRandom random(43, 0, i);
        exchanges += MeetInTheTip(gas, random);
        if (HasFailure()) return;
      }
      EXPECT_GT(exchanges, 300u);
    }
  }
}

// A ball that starts beyond a tip, where it misses all discs, after it has met the piston there. In
// its cell it would exchange again and again.
TEST(LaneGas, AnEscapedBallStopsAndCountsOnce) {
  const GasGeometry gas = GasOf(kPaperRho, 0.2, "3");
  GasState state = GasInEquilibrium(gas, 1, 44, 0);
  state.balls[1] = {.position = {0.47, 0.4}, .direction = {1, 0}, .speed = 1};
  const auto gases = InLanes(gas, state);
  const GasMeter& meter = gases->meters().front();
  gases->AdvanceTo(1);
  EXPECT_EQ(meter.escapes(), 1u);
  const double energy = meter.Energy(1);
  gases->AdvanceTo(100);
  EXPECT_EQ(meter.escapes(), 1u);
  EXPECT_EQ(meter.Energy(1), energy);
}

// A gas at rest except for one piston, which comes to a resting ball within its reach.
TEST(LaneGas, ThePistonMeetsABallAtRestAtItsPlace) {
  const GasGeometry gas = GasOf(kPaperRho, 0.15, "3");
  GasState state = AtRest(gas);
  const auto piston = static_cast<size_t>(gas.PistonOf(1, Direction::kRight));
  state.balls[1].position = {gas.pair().tip() - 0.05, 0};
  state.pistons[piston] = {.offset = 0, .velocity = -1};
  const auto gases = InLanes(gas, state);
  const GasMeter& meter = gases->meters().front();
  const double way = gas.pair().lambda() / 2 + 0.05;
  gases->AdvanceTo(way - 1e-6);
  EXPECT_EQ(meter.exchanges(), 0u);
  gases->AdvanceTo(way + 1e-6);
  EXPECT_EQ(meter.exchanges(), 1u);
  EXPECT_NEAR(meter.Energy(1), 0.5, 1e-12);  // the ball has the piston's velocity
  EXPECT_EQ(meter.Energy(3 + piston), 0);
}

}  // namespace
}  // namespace ballpiston
