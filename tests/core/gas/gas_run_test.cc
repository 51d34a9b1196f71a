#include "core/gas/gas_run.h"

#include "core/gas/current_meter.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_meter.h"
#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

constexpr double kWarmUp = 7, kEnd = 60;

// All that is measured of `count` replicas from `first` on, in a window of so many calls. The
// geometry's ends say whether the gas is periodic or between reservoirs of unequal temperatures.
std::vector<uint64_t> BitsOf(GasEngine engine, const GasGeometry& geometry, uint64_t first,
                             uint64_t count, int calls, double end) {
  std::vector<GasStart> starts;
  for (uint64_t replica = first; replica < first + count; ++replica) {
    const GasRandom random(91, 0, replica);
    CounterRandom of_start = random.OfStart();
    GasState state = DrawGas(geometry, TemperatureProfile(1), of_start);
    starts.push_back({std::move(state), ThermalWalls(geometry, 2, 1, random), random});
  }
  const auto run = StartGases(engine, geometry, GasExchangeRate(geometry, 1), std::move(starts));
  run->AdvanceTo(kWarmUp);
  for (GasMeter& meter : run->meters()) meter.Begin(kWarmUp);
  for (int i = 1; i <= calls; ++i) run->AdvanceTo(kWarmUp + (end - kWarmUp) * i / calls);
  std::vector<uint64_t> bits;
  for (GasMeter& meter : run->meters()) {
    meter.End(end);
    EXPECT_EQ(meter.escapes(), 0u);
    bits.push_back(meter.exchanges());
    bits.push_back(std::bit_cast<uint64_t>(meter.carried()));
    for (size_t body = 0; body < meter.bodies(); ++body) {
      bits.push_back(std::bit_cast<uint64_t>(meter.Energy(body)));
      bits.push_back(std::bit_cast<uint64_t>(meter.MeanEnergy(body)));
    }
  }
  return bits;
}

class GasRunOfEngine : public testing::TestWithParam<GasEngine> {};

// In a long run every engine moves the origin of its times, after some thousand events of each
// body.
TEST_P(GasRunOfEngine, CallsAndNeighboursDoNotChangeTheBits) {
  struct Run {
    const char* shape;
    double end;
    std::vector<int> calls;
  };
  for (const Run& run : {Run{"1", kEnd, {2, 7, 1000}}, {"3x2", kEnd, {7}}, {"2", 2000, {3000}}}) {
    for (const GasEnds ends : {GasEnds::kPeriodic, GasEnds::kReservoirs}) {
      const GasGeometry gas = GasOf(kPaperRho, 0.2, run.shape, ends);
      const std::vector<uint64_t> whole = BitsOf(GetParam(), gas, 0, 3, 1, run.end);
      for (const int calls : run.calls) {
        EXPECT_EQ(BitsOf(GetParam(), gas, 0, 3, calls, run.end), whole) << run.shape;
      }
      std::vector<uint64_t> alone;
      for (uint64_t replica = 0; replica < 3; ++replica) {
        const auto bits = BitsOf(GetParam(), gas, replica, 1, 3, run.end);
        alone.insert(alone.end(), bits.begin(), bits.end());
      }
      EXPECT_EQ(alone, whole) << run.shape;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(GasRun, GasRunOfEngine,
                         testing::Values(GasEngine::kReference, GasEngine::kLanes,
                                         GasEngine::kJumps));

// A hand-made history: ball 0 gives the energy 4 to the piston on its right, and piston 0 turns at
// a wall.
TEST(GasMeter, CountsAndAveragesFromTheStartOfTheWindow) {
  const GasGeometry gas = GasOf(kPaperRho, 0.2, "3");
  GasMeter meter(gas, AtRest(gas));
  const auto exchange = [&meter](double time, double ball_energy) {
    meter.See({EventKind::kBallPiston, time, 0, 1, Direction::kRight, ball_energy, 0.5});
  };
  exchange(0.5, 7);
  meter.Begin(0.5);
  exchange(1, 3);
  meter.See({.kind = EventKind::kPistonWall, .time = 2.5, .piston = 0, .piston_energy = 9});
  meter.End(4.5);
  EXPECT_EQ(meter.exchanges(), 1u);
  EXPECT_DOUBLE_EQ(meter.carried(), 4);
  EXPECT_DOUBLE_EQ(meter.MeanEnergy(0), (0.5 * 7 + 3.5 * 3) / 4);
  EXPECT_DOUBLE_EQ(meter.MeanEnergy(3), 2 * 9 / 4.0);
  EXPECT_DOUBLE_EQ(meter.MeanEnergy(4), 0.5);
}

// ---- current_meter.h ----

TEST(CurrentSteps, StepsHoldTheWholeCurrent) {
  constexpr double kDuration = 7;
  CurrentSteps constant(kDuration, kCurrentSteps);
  std::mt19937_64 random(3);
  std::exponential_distribution<double> wait(5);
  for (double since = 0; since < kDuration;) {
    const double end = std::min(since + wait(random), kDuration);
    constant.AddOver(std::exchange(since, end), end, 2);
  }
  for (const double value : constant.values()) EXPECT_NEAR(value, 2 * constant.length(), 1e-13);
  constant.AddAt(kDuration, 1);  // is in the last step
  EXPECT_NEAR(constant.values().back(), 2 * constant.length() + 1, 1e-13);
}

// Two exchanges, three steps apart, and nothing else: their product counts from a window of three
// steps on, and the product of an exchange with itself does not count.
TEST(CarriedCurrent, CountsProductsOfDifferentExchanges) {
  constexpr double kStep = 0.5, kRate = 0.25;
  constexpr size_t kCells = 2;
  CarriedCurrent current(kCells, kRate, kStep * kCurrentSteps);
  current.Exchange({.time = 10.1 * kStep}, 6);
  current.Exchange({.time = 13.7 * kStep}, -4);
  const GreenKubo result = current.Result();
  const double product = 3 * -2 / static_cast<double>(kCurrentSteps - 3);
  for (size_t lag = 0; lag <= kWindow; ++lag) {
    EXPECT_NEAR(result.autocorrelation[lag], lag == 3 ? product / (kCells * kStep * kStep) : 0,
                1e-14);
    EXPECT_NEAR(result.conductivity[lag], kRate / 2 + (lag < 3 ? 0 : product / (kCells * kStep)),
                1e-14);
  }
  EXPECT_EQ(result.plain, result.conductivity[kWindow]);
}

}  // namespace
}  // namespace ballpiston
