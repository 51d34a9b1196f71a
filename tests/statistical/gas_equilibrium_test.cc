// Gases in equilibrium: exchange rates, laws of energies, and the conservation of energy.
#include "core/experiment/gas_experiment.h"
#include "core/gas/hit_rates.h"
#include "tests/core/gas/gases.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"
#include "tests/support/nightly.h"
#include "tools/flows/metered_gases.h"

namespace ballpiston {
namespace {

constexpr uint64_t kGasSeed = 21;

class GasInEquilibriumOf : public testing::TestWithParam<std::tuple<Model, const char*>> {};

// Means over the canonical ensemble, from many replicas, and the laws of the speeds at their ends.
// Each of the three means is off by four standard errors in 6e-5 of all cases; the standard error
// of the rate is 0.3 % to 0.6 %. A divergence exceeds its noise by four standard errors as rarely
// or more rarely. False alarms of one case: 3e-4.
TEST_P(GasInEquilibriumOf, HasItsExactRateAndItsGammaLaws) {
  const auto& [model, shape] = GetParam();
  const PointParameters gas = PaperGas(&kGasEquilibrium, 0.2, ShapeNamed(shape));
  const int64_t replicas = 20'000 / ShapeNamed(shape).contacts();
  const PointSummary summary =
      RunPoint(SpecOf(&kGasEquilibrium, gas, {.samples = replicas}, model, kGasSeed));
  for (const char* name : {"exchange_rate", "temperature_ball", "temperature_piston"}) {
    const Estimate& mean = Named(name, summary.estimates);
    EXPECT_LT(std::fabs(*mean.ZScore()), 4) << name;
  }
  const Estimate& rate = Named("exchange_rate", summary.estimates);
  EXPECT_LT(*rate.standard_error, 0.007 * *rate.exact);
  for (const char* name : {"ball_speed_divergence", "piston_speed_divergence"}) {
    const Estimate& divergence = Named(name, summary.estimates);
    EXPECT_LT(divergence.value, *divergence.noise_floor + 4 * *divergence.standard_error) << name;
  }
  EXPECT_EQ(summary.health.escapes, 0u);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, GasInEquilibriumOf,
    testing::Combine(testing::Values(Model::kBilliardReference, Model::kMarkov, Model::kBilliard),
                     testing::Values("1", "2", "5", "1x1", "2x1", "1x3", "4x4")));

// A gas runs for 2e7 (nightly 1e8) wall hits of its balls, in ten stretches. Each exchange rounds
// two of 3072 energies, at random: together some 1e-16 of the whole; their sum here is rounded to
// some 1e-15. A loss of 1e-15 in each stretch would come to 1e-14.
TEST(LaneGas, KeepsItsEnergyOverMillionsOfHits) {
  constexpr int kStretches = 10;
  const double all_hits = IsNightly() ? 1e8 : 2e7;
  const GasGeometry gas = GasOf(kPaperRho, 0.1, "32x32");
  const double hits_of_time = HitRatesOf(gas.pair()).of_a_ball * static_cast<double>(gas.balls());
  MeteredGases run(GasEngine::kLanes, gas,
                   {{GasInEquilibrium(gas, 1, kGasSeed, 0), ThermalWalls(),
                     GasRandom(kGasSeed, 0, 0), nullptr}});
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
