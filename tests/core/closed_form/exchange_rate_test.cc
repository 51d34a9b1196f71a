#include "core/closed_form/exchange_rate.h"

#include "core/closed_form/canonical_measure.h"
#include "core/closed_form/kernel_moments.h"
#include "core/closed_form/mean_free_time.h"
#include "tests/core/preamble.h"
#include "tests/oracle/canonical_average.h"
#include "tests/oracle/measures_by_quadrature.h"
#include "tests/oracle/reference_table.h"

namespace ballpiston {
namespace {

double ExchangeRateOf(const PairGeometry& geometry, double temperature) {
  return ExchangeRate(Measures(geometry), temperature);
}

TEST(ExchangeRate, AccurateAtRandomGeometries) {
  std::mt19937_64 random(20250117);
  std::uniform_real_distribution<double> rho_exponent(-10, -0.01);
  std::uniform_real_distribution<double> delta_exponent(-12, 0);
  std::uniform_real_distribution<double> temperature_exponent(-120, 120);
  for (int i = 0; i < 100; ++i) {
    const double rho = kMinRho + (kMaxRho - kMinRho) * std::pow(10, rho_exponent(random));
    const double delta = PairDeltaBound(rho) * std::pow(10, delta_exponent(random));
    const double temperature = std::pow(10, temperature_exponent(random));
    const auto exact = oracle::MeasuresByQuadrature(rho, delta);
    const Quad t = temperature;
    EXPECT_LE(RelativeError(ExchangeRateOf(GeometryOf(rho, delta), temperature),
                            Sqrt(t / (2 * QuadPi())) * exact.area_ball_piston / exact.volume),
              kExchangeRateRelativeError);
    EXPECT_LE(RelativeError(RareLimitExchangeRate(rho, temperature),
                            Sqrt(t / QuadPi()) / exact.cell_area),
              kExchangeRateRelativeError);
  }
}

// The pair's energy E is a Gamma(3/2) variable of scale T, and at energy E the rate of collisions
// is sqrt(2 E)/tau_bp.
TEST(ExchangeRate, IsTheAverageOfTheMicrocanonicalRate) {
  for (double temperature : {1e-3, 1.0, 50.0}) {
    const double mean_speed = std::sqrt(2 * temperature) * std::tgamma(2) / std::tgamma(1.5);
    const double expected = mean_speed / MeanFreeTimesOf(kPaperPair).ball_piston;
    EXPECT_NEAR(ExchangeRateOf(kPaperPair, temperature) / expected, 1, 1e-14);
  }
}

// Mean of the current j if the ball has temperature T + t/2 and the piston T - t/2, by weights on
// the canonical density at T. In units of |dG_bp|/|G|.
double CurrentBetween(double temperature, double difference) {
  const double beta = 1 / temperature;
  const double ball = 1 / (temperature + difference / 2);
  const double piston = 1 / (temperature - difference / 2);
  return oracle::CanonicalAverage(beta, [&](double eb, double ep) {
    const double weight = ball / beta * std::sqrt(piston / beta) *
                          std::exp((beta - ball) * eb + (beta - piston) * ep);
    return weight * EnergyCurrent(eb, ep);
  });
}

// A gradient of one unit from cell to cell is a difference of 1/2 between a ball and the next
// piston. Terms of second order in t/T = 0.01 are the tolerance.
TEST(ExchangeRate, HalfTheRateIsTheStaticConductivity) {
  for (double temperature : {0.5, 2.0}) {
    const double difference = 0.01 * temperature;
    const double conducted = (CurrentBetween(temperature, difference) / difference) / 2;
    const double rate = AveragesAt(1 / temperature).mean_f;
    EXPECT_NEAR(conducted / StaticConductivity(rate), 1, 1e-4);
  }
}

// Eight balls between pistons at T = 2 and 1, in the limit of rare collisions. The conductivity
// grows as sqrt(T), so the current J gives J N sqrt(T)/[(2/3) (2^1.5 - 1)] at T. The dynamic
// correlations are smaller than the tolerance, 4 standard errors of the table or 3.3 %.
TEST(ExchangeRate, HalfTheRateMatchesTheConductivityOfAReferenceGas) {
  const ReferenceTable table("gas.csv");
  const size_t row = 1;
  const double hot = table.Input(row, "hot"), cold = table.Input(row, "cold");
  const double per_current =
      table.Input(row, "cells") * 1.5 / (std::pow(hot, 1.5) - std::pow(cold, 1.5));
  EXPECT_NEAR(table.Input(row, "value") * per_current, StaticConductivity(AveragesAt(1).mean_f),
              4 * table.Input(row, "standard_error") * per_current);
}

}  // namespace
}  // namespace ballpiston
