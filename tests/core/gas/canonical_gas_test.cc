#include "core/gas/canonical_gas.h"

#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"
#include "tests/oracle/samples.h"

namespace ballpiston {
namespace {

bool HasBallBeyondPiston(const GasGeometry& gas, const GasState& state) {
  for (int64_t ball = 0; ball < gas.balls(); ++ball) {
    for (int i = 0; i < gas.directions(); ++i) {
      if (GapTo(gas, state, ball, gas.DirectionAt(i)) <= 0) return true;
    }
  }
  return false;
}

// By definition: all positions are drawn again until no ball is beyond a piston.
GasState DrawnAsAWhole(const GasGeometry& gas, CounterRandom& random) {
  GasState state = AtRest(gas);
  do {
    for (GasBall& ball : state.balls) {
      do {
        ball.position = {random.Uniform() - 0.5, random.Uniform() - 0.5};
      } while (!InsideCell(gas.pair(), ball.position));
    }
    for (GasPiston& piston : state.pistons) {
      piston.offset = (2 * random.Uniform() - 1) * gas.reach();
    }
  } while (HasBallBeyondPiston(gas, state));
  return state;
}

// The quantities in which the two samples are compared: pistons inside cells; pistons inside of the
// first cell; positions of a ball and a piston; the narrowest gap.
struct Observed {
  std::vector<uint64_t> inside_cells = std::vector<uint64_t>(20);
  std::vector<uint64_t> inside_first = std::vector<uint64_t>(5);
  std::vector<double> ball, piston, narrowest;

  void Add(const GasGeometry& gas, const GasState& state) {
    const double edge = gas.pair().lambda() / 2;
    const auto is_inside = [&](const GasPiston& p) { return std::fabs(p.offset) > edge; };
    ++inside_cells[static_cast<size_t>(
        std::count_if(state.pistons.begin(), state.pistons.end(), is_inside))];
    size_t inside = 0;
    double gap = 1;
    for (int i = 0; i < gas.directions(); ++i) {
      const Direction direction = gas.DirectionAt(i);
      const auto number = static_cast<size_t>(gas.PistonOf(0, direction));
      inside += SignOf(direction) * state.pistons[number].offset < -edge;
      gap = std::min(gap, GapTo(gas, state, 0, direction));
    }
    ++inside_first[inside];
    ball.push_back(state.balls[0].position.x());
    piston.push_back(state.pistons.back().offset);
    narrowest.push_back(gap);
  }
};

// False alarms: 2e-4 a gas. Pistons with uniform offsets, as if they took no area from any cell,
// would be detected.
TEST(CanonicalGas, PositionsMatchPlainRejection) {
  for (const auto& [shape, ends] : {std::pair("1", GasEnds::kPeriodic),
                                    {"2", GasEnds::kPeriodic},
                                    {"5", GasEnds::kPeriodic},
                                    {"3", GasEnds::kReservoirs},
                                    {"1x1", GasEnds::kPeriodic},
                                    {"2x1", GasEnds::kPeriodic},
                                    {"2x2", GasEnds::kPeriodic},
                                    {"2x2", GasEnds::kReservoirs}}) {
    SCOPED_TRACE(shape);
    // Crowded: a piston takes 1.8 % of a cell on either side, and is inside of a cell half of the
    // time.
    const GasGeometry gas = GasAtShare(0.52, 1, shape, ends);
    Observed drawn, expected;
    const auto configurations = static_cast<uint64_t>(200'000 / gas.balls());
    for (uint64_t i = 0; i < configurations; ++i) {
      drawn.Add(gas, GasInEquilibrium(gas, 1, 63, i));
      CounterRandom random(64, 0, i);
      expected.Add(gas, DrawnAsAWhole(gas, random));
    }
    EXPECT_LT(oracle::ChiSquareScore(drawn.inside_cells, expected.inside_cells), 4);
    EXPECT_LT(oracle::ChiSquareScore(drawn.inside_first, expected.inside_first), 4);
    EXPECT_LT(oracle::KolmogorovSmirnov(drawn.ball, expected.ball), 2.3);
    EXPECT_LT(oracle::KolmogorovSmirnov(drawn.piston, expected.piston), 2.3);
    EXPECT_LT(oracle::KolmogorovSmirnov(drawn.narrowest, expected.narrowest), 2.3);
    if (gas.pistons() > 1) continue;
    const auto uniform = [&gas](double offset) { return 0.5 + offset / (2 * gas.reach()); };
    EXPECT_GT(oracle::KolmogorovSmirnov(drawn.piston, uniform), 2.3 * M_SQRT2);
  }
}

// Down to the smallest ratio of the permitted temperatures. Long double has 11 bits more.
TEST(TemperatureProfile, PowerThreeHalvesIsLinearForEveryRatioOfTemperatures) {
  for (const double hot : {1e120, 1.0, 1e-120}) {
    for (double ratio = 1; hot * ratio >= 1e-120; ratio /= 30) {
      const double cold = hot * ratio;
      for (const int columns : {1, 3, 1000, 1'000'000}) {
        const TemperatureProfile profile(hot, cold, columns);
        EXPECT_EQ(profile.At(0), hot);
        EXPECT_EQ(profile.At(columns), cold);
        for (const double x : {0.0, 0.5, columns / 2.0, columns - 0.5, double(columns)}) {
          const long double cold_part = x * std::pow(static_cast<long double>(ratio), 1.5L);
          const long double cube = (columns - x + cold_part) / columns;
          const auto exact = static_cast<double>(hot * std::pow(cube, 2.0L / 3));
          EXPECT_NEAR(profile.At(x) / exact, 1, 1e-15) << cold / hot << " at " << x / columns;
          EXPECT_GE(profile.At(x), cold);
        }
      }
    }
  }
  for (const double x : {0.0, 0.3, 1.0}) {
    EXPECT_EQ(TemperatureProfile(3).At(x), 3);
    EXPECT_EQ(TemperatureProfile(3, 3, 1).At(x), 3);
  }
}

}  // namespace
}  // namespace ballpiston
