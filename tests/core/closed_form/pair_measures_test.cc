// The measures of the pair, and the mean free times and exchange rates that follow from them.
#include "core/closed_form/pair_measures.h"

#include "core/closed_form/exchange_rate.h"
#include "core/closed_form/mean_free_time.h"
#include "tests/core/preamble.h"
#include "tests/oracle/measures_by_quadrature.h"
#include "tools/flows/printed_formulas.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston {
namespace {

using std::numbers::sqrt2;

double WorstError(const PairMeasures& m, const PrintedMeasures<Quad>& exact) {
  return std::max({RelativeError(m.eta, exact.eta), RelativeError(m.cell_area, exact.cell_area),
                   RelativeError(m.volume, exact.volume),
                   RelativeError(m.area_ball_piston, exact.area_ball_piston),
                   RelativeError(m.area_ball_wall, exact.area_ball_wall),
                   RelativeError(m.area_piston_wall, exact.area_piston_wall)});
}

void ExpectAccurate(const PairGeometry& geometry, double temperature) {
  const auto exact = oracle::MeasuresByQuadrature(geometry.rho(), geometry.delta());
  const PairMeasures measures = Measures(geometry);
  EXPECT_LE(WorstError(measures, exact), kPairMeasuresRelativeError);
  const MeanFreeTimes tau = MeanFreeTimesOf(geometry);
  for (const auto& [time, area] : {std::pair(tau.ball_piston, exact.area_ball_piston),
                                   {tau.ball_wall, exact.area_ball_wall},
                                   {tau.piston_wall, exact.area_piston_wall}}) {
    EXPECT_LE(RelativeError(time, 4 * exact.volume / area), kMeanFreeTimeRelativeError);
  }
  const Quad t = temperature;
  EXPECT_LE(RelativeError(ExchangeRate(measures, temperature),
                          sqrt(t / (2 * QuadPi())) * exact.area_ball_piston / exact.volume),
            kExchangeRateRelativeError);
  EXPECT_LE(RelativeError(RareLimitExchangeRate(geometry.rho(), temperature),
                          sqrt(t / QuadPi()) / exact.cell_area),
            kExchangeRateRelativeError);
}

// Anywhere; where the cell vanishes; at the bound of delta; at the smallest radius.
TEST(PairMeasures, AccurateForEveryGeometry) {
  std::mt19937_64 random(20240601);
  std::uniform_real_distribution<double> rho_exponent(-10, -0.01), near_half(-15.5, -0.01);
  std::uniform_real_distribution<double> delta_exponent(-12, -0.001),
      temperature_exponent(-120, 120);
  const auto above_half = [](double exponent) {
    return 0.5 + (kMaxRho - 0.5) * std::pow(10, exponent);
  };
  std::vector<std::pair<double, double>> geometries;  // rho, share of the bound
  for (int i = 0; i < 300; ++i) {
    geometries.emplace_back(above_half(rho_exponent(random)), std::pow(10, delta_exponent(random)));
  }
  for (double gap : {1e-2, 1e-3, 1e-5, 1e-7, 1e-10}) {
    for (double share : {1.0, 0.9, 1e-3, 1e-6}) geometries.emplace_back(kMaxRho - gap, share);
  }
  for (int i = 0; i < 100; ++i) geometries.emplace_back(above_half(near_half(random)), 1);
  for (double share : {1.0, 1 - 0x1p-53, 1 - 1e-12, 0.5, 1e-6, 1e-12}) {
    geometries.emplace_back(std::nextafter(0.5, 1.0), share);
  }
  for (const auto& [rho, share] : geometries) {
    if (rho == 0.5) continue;
    SCOPED_TRACE(absl::StrCat("rho ", rho, " share ", share));
    ExpectAccurate(GeometryAtShare(rho, share), std::pow(10, temperature_exponent(random)));
  }
}

TEST(PairMeasures, RareCollisionsSeeAWedge) {
  for (double rho : {0.501, kPaperRho, 0.6, 0.7}) {
    for (double delta : {1e-8, 1e-12, 1e-100}) {
      const double area = Measures(GeometryOf(rho, delta)).area_ball_piston;
      // The next order is delta/lambda, of which lambda >= 0.06 here.
      EXPECT_NEAR(area / delta / delta / (sqrt2 * Lambda(rho)), 1, 1e-14 + 40 * delta);
    }
  }
}

}  // namespace
}  // namespace ballpiston
