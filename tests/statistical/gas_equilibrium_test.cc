// Gases in equilibrium: exchange rates, laws of energies, and the conservation of energy.
#include "core/gas/hit_rates.h"
#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"
#include "tests/oracle/one_sample.h"
#include "tests/statistical/gas_samples.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

constexpr uint64_t kGasSeed = 21;

// Exchanges of a contact in a unit of time, by replica.
Moments RateOf(const GasSamples& samples, const GasTask& task) {
  Moments rate;
  for (const double exchanges : samples.exchanges) {
    rate.Add(exchanges / task.time / static_cast<double>(task.geometry.contacts()));
  }
  return rate;
}

// Gamma(1) of balls, Gamma(1/2) of pistons. Each distance exceeds 2.3 in 5e-5 of all cases.
void ExpectGammaLaws(const GasSamples& samples) {
  EXPECT_LT(oracle::KolmogorovSmirnov(samples.balls, [](double e) { return -std::expm1(-e); }),
            2.3);
  EXPECT_LT(
      oracle::KolmogorovSmirnov(samples.pistons, [](double e) { return std::erf(std::sqrt(e)); }),
      2.3);
}

class GasInEquilibriumOf : public testing::TestWithParam<std::tuple<GasEngine, const char*>> {};

// The mean over the canonical ensemble, from many replicas. The rate differs by four standard
// errors, of 0.2 % to 0.6 % each, in 6e-5 of all cases; the final energies of all bodies are
// independent. Together 2e-4 false alarms each.
TEST_P(GasInEquilibriumOf, HasItsExactRateAndItsGammaLaws) {
  const auto& [engine, shape] = GetParam();
  const GasGeometry gas = GasOf(kPaperRho, 0.2, shape);
  const GasTask task = {engine, gas, static_cast<uint64_t>(20'000 / gas.contacts()), 50, kGasSeed};
  const GasSamples samples = Measure(task);
  const Moments rate = RateOf(samples, task);
  const double exact = GasExchangeRate(gas, 1), error = *rate.StandardError();
  EXPECT_NEAR(rate.mean, exact, 4 * error);
  EXPECT_LT(error, 0.007 * exact);
  ExpectGammaLaws(samples);
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
  const GasTask task = {GasEngine::kJumps, gas, 2, 1000, kGasSeed};
  const GasSamples samples = Measure(task);
  EXPECT_LT(std::fabs(RateOf(samples, task).mean / GasExchangeRate(gas, 1) - 1), 0.02);
  ExpectGammaLaws(samples);
}

// A gas runs for 2e7 (nightly 1e8) wall hits of its balls, in ten stretches. Each exchange rounds
// two of 3072 energies, at random: together some 1e-16 of the whole; their sum here is rounded to
// some 1e-15. A loss of 1e-15 in each stretch would come to 1e-14.
TEST(LaneGas, KeepsItsEnergyOverMillionsOfHits) {
  constexpr int kStretches = 10;
  const double all_hits = IsNightly() ? 1e8 : 2e7;
  const GasGeometry gas = GasOf(kPaperRho, 0.1, "32x32");
  const double hits_of_time = HitRatesOf(gas.pair()).of_a_ball * static_cast<double>(gas.balls());
  MeteredGases run = ReplicaOf({GasEngine::kLanes, gas, 1, 0, kGasSeed}, 0);
  const GasMeter& meter = run.meters().front();
  const double energy = meter.TotalEnergy();
  for (int i = 1; i <= kStretches; ++i) {
    run.AdvanceTo(i * all_hits / kStretches / hits_of_time);
    EXPECT_LT(std::fabs(meter.TotalEnergy() / energy - 1), 5e-15) << "stretch " << i;
  }
  EXPECT_EQ(meter.escapes(), 0u);
  EXPECT_GT(static_cast<double>(meter.exchanges()), all_hits / 100);
}

}  // namespace
}  // namespace ballpiston
