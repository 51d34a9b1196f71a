// Compares gases between a hot and a cold reservoir with an independent plain program. The heat
// currents and their standard errors are copied from tests/data/gas.csv.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_run.h"
#include "core/geometry/paper.h"
#include "tests/core/gas/gases.h"
#include "tests/statistical/gas_samples.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

constexpr uint64_t kConductionSeed = 22;

// The gas relaxes in some 0.3 n^2/rate.
double RelaxationTime(const GasGeometry& gas) {
  const auto cells = static_cast<double>(gas.shape().columns);
  return 0.3 * cells * cells / InfiniteGasExchangeRate(gas, 1);
}

GasSamples Conduct(GasEngine engine, const GasGeometry& gas, double hot, double cold,
                   uint64_t replicas, double duration) {
  return Measure({.engine = engine,
                  .geometry = gas,
                  .hot = hot,
                  .cold = cold,
                  .replicas = replicas,
                  .begin = 4 * RelaxationTime(gas),
                  .duration = duration},
                 kConductionSeed);
}

GasGeometry ChainOf(double delta, const char* cells) {
  return GasOf(kPaperRho, delta, cells, GasEnds::kReservoirs);
}

// The reference's unit of time is one over |dG_bp|/|G|, which is sqrt(2 pi) times the exchange rate
// at temperature 1.
double UnitOfRates(const GasGeometry& gas) {
  return std::sqrt(2 * std::numbers::pi) * InfiniteGasExchangeRate(gas, 1);
}

// The error of the reference's temperatures is at least the last printed digit. Their standard
// errors are unknown, but the reference's run was at least as long as this run. Four standard
// errors.
void ExpectTemperatures(const GasSamples& samples, const std::vector<double>& expected) {
  for (size_t body = 0; body < expected.size(); ++body) {
    const Moments& temperature = samples.temperatures[body];
    const double error = std::fmax(temperature.StandardError().value(), 5e-4);
    EXPECT_LT(StandardErrorsOff(temperature, expected[body], error), 4)
        << "body " << body << " at " << temperature.mean;
  }
}

// Of each current a difference of four combined standard errors has 6e-5 false alarms.
TEST(GasConduction, JumpsOfTwoCellsCarryTheReferencesCurrent) {
  const GasGeometry gas = ChainOf(0.2, "2");
  const GasSamples samples = Conduct(GasEngine::kJumps, gas, 1.5, 0.5, 4000, 2000);
  const double unit = UnitOfRates(gas);
  EXPECT_LT(StandardErrorsOff(samples.current, 0.098723 * unit, 0.000181 * unit), 4)
      << samples.current.mean / unit;
  EXPECT_LT(samples.current.StandardError().value(), 0.005 * samples.current.mean);
  ExpectTemperatures(samples, {1.272, 0.778, 1.5, 1.026, 0.5});
}

TEST(GasConduction, JumpsOfEightCellsCarryTheReferencesCurrent) {
  const GasGeometry gas = ChainOf(0.2, "8");
  const GasSamples samples = Conduct(GasEngine::kJumps, gas, 2, 1, 500, 3000);
  const double unit = UnitOfRates(gas);
  EXPECT_LT(StandardErrorsOff(samples.current, 0.030476 * unit, 0.000255 * unit), 4)
      << samples.current.mean / unit;
  EXPECT_LT(samples.current.StandardError().value(), 0.025 * samples.current.mean);
}

TEST(GasConduction, ABilliardOfTwoCellsCarriesTheReferencesCurrent) {
  const GasSamples samples =
      Conduct(GasEngine::kReference, ChainOf(0.15, "2"), 2, 1, IsNightly() ? 2000 : 1000, 500);
  EXPECT_LT(StandardErrorsOff(samples.current, 0.019931, 0.000150), 4) << samples.current.mean;
  EXPECT_LT(samples.current.StandardError().value(),
            (IsNightly() ? 0.03 : 0.043) * samples.current.mean);
  ExpectTemperatures(samples, {1.752, 1.269, 1.976, 1.512, 1.021});
}

// The current is more than ten of its standard errors.
TEST(GasConduction, HeatFlowsFromHotToCold) {
  for (const GasEngine engine : {GasEngine::kReference, GasEngine::kJumps}) {
    for (const char* shape : {"1", "2x2"}) {
      const GasSamples samples = Conduct(engine, ChainOf(0.2, shape), 2, 1, 300, 300);
      EXPECT_GT(samples.current.mean, 10 * samples.current.StandardError().value()) << shape;
    }
  }
}

}  // namespace
}  // namespace ballpiston
