// Gases in equilibrium: exchange rates, laws of energies, and a chain between equal reservoirs.
#include "core/gas/current_meter.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_run.h"
#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"
#include "tests/oracle/one_sample.h"
#include "tests/statistical/gas_samples.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

constexpr uint64_t kGasSeed = 21;

// Energies in units of T. Each distance exceeds 2.3 in 5e-5 of all cases.
void ExpectGammaOne(const std::vector<double>& energies) {
  EXPECT_LT(oracle::KolmogorovSmirnov(energies, [](double e) { return -std::expm1(-e); }), 2.3);
}
void ExpectGammaHalf(const std::vector<double>& energies) {
  EXPECT_LT(oracle::KolmogorovSmirnov(energies, [](double e) { return std::erf(std::sqrt(e)); }),
            2.3);
}

class GasInEquilibriumOf : public testing::TestWithParam<std::tuple<GasEngine, const char*>> {};

// The mean over the canonical ensemble, from many replicas. The rate differs by four standard
// errors, of 0.2 % to 0.6 % each, in 6e-5 of all cases; the final energies of all bodies are
// independent. Together 2e-4 false alarms each.
TEST_P(GasInEquilibriumOf, HasItsExactRateAndItsGammaLaws) {
  const auto& [engine, shape] = GetParam();
  const GasGeometry gas = GasOf(kPaperRho, 0.2, shape);
  const auto replicas = static_cast<uint64_t>(20'000 / gas.contacts());
  const GasSamples samples =
      Measure({.engine = engine, .geometry = gas, .replicas = replicas, .duration = 50}, kGasSeed);
  const double exact = GasExchangeRate(gas, 1);
  EXPECT_LT(StandardErrorsOff(samples.rate, exact), 4) << samples.rate.mean << " not " << exact;
  EXPECT_LT(samples.rate.StandardError().value(), 0.007 * exact);
  const auto balls = static_cast<size_t>(gas.balls());
  ExpectGammaOne(LastEnergies(samples, 0, balls));
  ExpectGammaHalf(LastEnergies(samples, balls, samples.last.size()));
}

INSTANTIATE_TEST_SUITE_P(Shapes, GasInEquilibriumOf,
                         testing::Combine(testing::Values(GasEngine::kReference, GasEngine::kJumps),
                                          testing::Values("1", "2", "5", "1x1", "2x1", "1x3",
                                                          "4x4")));
// The lanes are slow in small gases.
INSTANTIATE_TEST_SUITE_P(Lanes, GasInEquilibriumOf,
                         testing::Combine(testing::Values(GasEngine::kLanes),
                                          testing::Values("2", "1x1", "4x4")));

// After a hundred exchanges of each contact, of one large gas. False alarms: 1e-4.
TEST(JumpGas, KeepsTheGammaLaws) {
  const GasGeometry gas = GasOf(kPaperRho, 0.2, "100x40");
  const GasSamples samples = Measure(
      {.engine = GasEngine::kJumps, .geometry = gas, .replicas = 2, .duration = 1000}, kGasSeed);
  EXPECT_LT(std::fabs(samples.rate.mean / GasExchangeRate(gas, 1) - 1), 0.02);
  ExpectGammaOne(LastEnergies(samples, 0, 4000));
  ExpectGammaHalf(LastEnergies(samples, 4000, samples.last.size()));
}

// Twice the static conductivity, from the squares of the energies that exchanges carry over half a
// cell.
class SquaresMeter : public CurrentMeter {
 public:
  explicit SquaresMeter(double& sum) : sum_(sum) {}
  void Exchange(const GasExchange&, double carried) override { sum_ += carried * carried / 4; }
  void End(double) override {}
  GreenKubo Result() const override { return {}; }

 private:
  double& sum_;
};

// CarriedCurrent leaves these squares out, because their mean is known. To 0.5 % and 2.3 %, nightly
// to 0.3 % and 1.4 %; four standard errors are exceeded in 6e-5 of all cases.
TEST(CarriedCurrent, SquaredExchangesGiveTheStaticConductivity) {
  const GasGeometry gas = GasOf(kPaperRho, 0.2, "4");
  const double rate = GasExchangeRate(gas, 1), duration = 8 / rate;
  struct Run {
    GasEngine engine;
    int replicas;
    double precision;
  };
  const auto runs = IsNightly() ? std::array<Run, 2>{{{GasEngine::kJumps, 200'000, 0.0035},
                                                      {GasEngine::kReference, 8000, 0.018}}}
                                : std::array<Run, 2>{{{GasEngine::kJumps, 80'000, 0.0055},
                                                      {GasEngine::kReference, 3200, 0.028}}};
  for (const auto& [engine, replicas, precision] : runs) {
    Moments squares;
    for (int replica = 0; replica < replicas; ++replica) {
      const GasRandom random(kGasSeed, 7, static_cast<uint64_t>(replica));
      CounterRandom of_start = random.OfStart();
      GasState state = DrawGas(gas, TemperatureProfile(1), of_start);
      GasMeter meter(gas, state);
      double sum = 0;
      meter.MeasureCurrent(std::make_unique<SquaresMeter>(sum));
      std::vector<GasStart> starts;
      starts.push_back({std::move(state), {}, random, &meter});
      StartGases(engine, gas, rate, std::move(starts))->AdvanceTo(duration);
      squares.Add(sum / (2 * 4 * duration) / (rate / 2));
    }
    EXPECT_LT(StandardErrorsOff(squares, 1), 4) << squares.mean;
    EXPECT_LT(squares.StandardError().value(), precision);
  }
}

// No current and one temperature, each within four standard errors; the balls next to the
// reservoirs at the end of the run have the law Gamma(1). False alarms: 9e-4.
void ExpectEquilibriumBetweenEqualReservoirs(GasEngine engine, uint64_t replicas,
                                             const char* shape) {
  const GasGeometry gas = GasOf(kPaperRho, 0.2, shape, GasEnds::kReservoirs);
  const GasSamples samples = Measure(
      {.engine = engine, .geometry = gas, .replicas = replicas, .begin = 20, .duration = 150},
      kGasSeed + 1);
  EXPECT_LT(StandardErrorsOff(samples.current, 0), 4);
  EXPECT_LT(StandardErrorsOff(samples.rate, InfiniteGasExchangeRate(gas, 1)), 4);
  const auto balls = static_cast<size_t>(gas.balls());
  for (size_t body = 0; body < samples.temperatures.size(); ++body) {
    // For an outermost piston the jump process has only the mean.
    const Moments& temperature = samples.temperatures[body];
    if (temperature.m2 < 1e-6) continue;
    EXPECT_LT(StandardErrorsOff(temperature, 1), 4) << "body " << body;
  }
  ExpectGammaOne(samples.last[0]);
  ExpectGammaOne(samples.last[balls - 1]);
}

TEST(JumpGas, EqualReservoirsAreAnEquilibrium) {
  ExpectEquilibriumBetweenEqualReservoirs(GasEngine::kJumps, 10'000, "3");
}

TEST(ReferenceGas, EqualReservoirsAreAnEquilibrium) {
  ExpectEquilibriumBetweenEqualReservoirs(GasEngine::kReference, 2000, "3");
}

}  // namespace
}  // namespace ballpiston
