#include "core/closed_form/exchange_rate.h"

#include "tests/core/preamble.h"
#include "tests/oracle/measures_by_quadrature.h"

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

}  // namespace
}  // namespace ballpiston
