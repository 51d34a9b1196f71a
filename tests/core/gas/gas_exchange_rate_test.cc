#include "core/gas/gas_exchange_rate.h"

#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"
#include "tests/oracle/gas_configurations.h"
#include "tests/oracle/reference_table.h"

namespace ballpiston {
namespace {

// Relative difference of two rates. Oracles in double add the rounding of some 1e5 operations.
constexpr double kOracleError = 2e-14;
void ExpectSameRate(double rate, double exact) {
  EXPECT_NEAR(rate / exact, 1, kGasExchangeRateRelativeError + kOracleError);
}

TEST(GasExchangeRate, RingsAreTracesOfTheirTransferOperator) {
  for (const double rho : {0.5001, 0.51, kPaperRho, 0.6, 0.7}) {
    for (const double share : {1.0, 0.5, 0.1}) {
      const double delta = share * GasDeltaBound(rho);
      const oracle::ChainByQuadrature chain(rho, delta);
      for (const int cells : {1, 2, 3, 6, 50}) {
        SCOPED_TRACE(absl::StrCat("rho ", rho, " delta ", delta, " cells ", cells));
        const GasGeometry gas = GasOf(rho, delta, absl::StrCat(cells));
        ExpectSameRate(GasExchangeRate(gas, 1), chain.RateOfRing(cells, 1));
      }
    }
  }
}

// For z = 0 no piston takes area from a cell, and the factor is 1. No geometry has a z above 0.02.
TEST(GasExchangeRate, ToriCountEveryConfiguration) {
  for (const double z : {0.0, 1e-6, 1e-3, 0.01, 0.02}) {
    for (int columns = 1; columns <= 7; ++columns) {
      for (int rows = 1; rows <= 5; ++rows) {
        SCOPED_TRACE(absl::StrCat(columns, "x", rows, " z ", z));
        const double factor = CrowdingFactor({columns, rows, true}, z);
        ExpectSameRate(factor, oracle::TorusByStates(columns, rows, z));
        EXPECT_EQ(factor, CrowdingFactor({rows, columns, true}, z));
      }
    }
  }
}

// The difference between a finite and the infinite gas falls by a factor of at least ten from one
// size to the next, down to the error of the infinite lattice.
TEST(GasExchangeRate, LargeGasesTendToTheInfiniteOne) {
  for (const double z : {0.0, 0.005, 0.02}) {
    for (const bool is_lattice : {false, true}) {
      const double infinite = InfiniteCrowdingFactor(is_lattice, z);
      double before = 1;
      for (int n = 1; n <= 7; ++n) {
        const double factor =
            is_lattice ? oracle::TorusByStates(n, n, z) : CrowdingFactor({n, 1, false}, z);
        const double difference = std::fabs(factor / infinite - 1);
        EXPECT_LT(difference, std::fmax(before / 10, kGasExchangeRateRelativeError))
            << "z " << z << " size " << n;
        before = difference;
      }
      EXPECT_LT(before, kGasExchangeRateRelativeError);
      for (const int n : {8, 9, 20, 1000}) {
        const GasShape shape = {n, is_lattice ? n : 1, is_lattice};
        ExpectSameRate(CrowdingFactor(shape, z), infinite);
      }
    }
  }
}

// A tube, long on one side and narrow on the other, is not the infinite lattice.
TEST(GasExchangeRate, LongTubesDependOnTheirWidth) {
  for (const double z : {0.005, 0.02}) {
    for (int width = 1; width <= 5; ++width) {
      const double exact = oracle::TorusByStates(40, width, z);
      for (const int length : {8, 40, 1000}) {
        ExpectSameRate(CrowdingFactor({length, width, true}, z), exact);
        ExpectSameRate(CrowdingFactor({width, length, true}, z), exact);
      }
    }
    EXPECT_GT(std::fabs(CrowdingFactor({40, 2, true}, z) / InfiniteCrowdingFactor(true, z) - 1),
              1e-8);
  }
}

// In the canonical ensemble the energy E of k pairs of velocity components, T each, has the law
// Gamma(k): the mean of sqrt(E) is sqrt(T) Gamma(k + 1/2)/Gamma(k). Within four standard errors of
// the program: 6e-5 false alarms each.
TEST(GasExchangeRate, AgreesWithAnIndependentProgram) {
  const auto at_fixed_energy = [](const GasGeometry& gas) {
    const double k = static_cast<double>(gas.balls()) + static_cast<double>(gas.pistons()) / 2;
    return GasExchangeRate(gas, 1) * std::sqrt(k) * std::exp(std::lgamma(k) - std::lgamma(k + 0.5));
  };
  int compared = 0;
  for (const oracle::ReferenceRow& row : oracle::ReferenceTable("gas.csv")) {
    if (row.at("quantity") != "exchange_rate") continue;
    const GasGeometry gas =
        GasOf(oracle::Number(row, "rho"), oracle::Number(row, "delta"), row.at("cells"));
    EXPECT_NEAR(at_fixed_energy(gas), oracle::Number(row, "value"),
                4 * oracle::Number(row, "standard_error"));
    ++compared;
  }
  EXPECT_EQ(compared, 2);
}

}  // namespace
}  // namespace ballpiston
