// The measures of the pair, and the mean free times and exchange rates that follow from them.
#include "core/closed_form/pair_measures.h"

#include "core/closed_form/exchange_rate.h"
#include "core/closed_form/kernel.h"
#include "core/closed_form/mean_free_time.h"
#include "tests/core/preamble.h"
#include "tests/oracle/measures_by_quadrature.h"
#include "tools/flows/printed_formulas.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston {
namespace {

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

// ---- mean_free_time.h ----

// For small delta the collision surface is a wedge of the area sqrt(2) lambda delta^2.
TEST(MeanFreeTime, RareLimitRateIsTheLimitOfTheRate) {
  for (double rho : {0.501, kPaperRho, 0.6, 0.65, 0.7}) {
    for (double fraction : {1e-3, 1e-6, 1e-9, 1e-100}) {
      const double delta = fraction * PairDeltaBound(rho);
      const double rate = 1 / (MeanFreeTimesOf(GeometryOf(rho, delta)).ball_piston * delta * delta);
      // The leading correction, a few delta/lambda, is the reason for the tolerance's second term.
      EXPECT_NEAR(rate / RareLimitRate(rho), 1, 1e-13 + 4 * delta / Lambda(rho)) << rho;
    }
  }
}

double ErrorOfPhi(double ep) {
  const Quad eb = Quad{1} / 2 - Quad{ep};
  return RelativeError(Phi(ep), 4 * CollisionRateAsPrinted(eb, Quad{ep}, QuadPi()));
}

TEST(MeanFreeTime, PhiIsAccurateForEveryEnergy) {
  for (double ep : {0.0, 1e-300, 0.5}) EXPECT_LE(ErrorOfPhi(ep), kConditionalRateRelativeError);
  std::mt19937_64 random(20240604);
  std::uniform_real_distribution<double> exponent(-14, 0);
  for (int i = 0; i < 500; ++i) {
    const double small = 0.5 * std::pow(10, exponent(random));
    for (double ep : {small, 0.5 - small, 0.25 + small / 2, 0.25 - small / 2}) {
      EXPECT_LE(ErrorOfPhi(ep), kConditionalRateRelativeError) << ep;
    }
  }
}

// A small delta. The ball meets a resting piston if the piston is within delta of the tip, which is
// delta/(lambda + 2 delta) of the volume. A resting ball waits until the piston has gone to its far
// wall and back, 2 (lambda + 2 delta) at speed 1. Both hold to first order in delta.
TEST(MeanFreeTime, AtRestOnlyTheVisitedPartCounts) {
  const double delta = 1e-6;
  const PairGeometry geometry = PaperGeometry(delta);
  const double tau = MeanFreeTimesOf(geometry).ball_piston, lambda = geometry.lambda();
  EXPECT_NEAR(ConditionalMeanFreeTime(geometry, 0) * Phi(0) / tau, delta / (lambda + 2 * delta),
              10 * delta * delta);
  EXPECT_NEAR(ConditionalMeanFreeTime(geometry, 0.5), 2 * lambda, 10 * delta);
}

// ---- exchange_rate.h ----

// The average over eq. canmeasure of a function of (eb, ep) that is (2 E)^power times `of_pair` at
// the total energy 1/2, where E = eb + ep. E has the law Gamma(3/2), and is independent of
// u = sqrt(ep/E), which is uniform. The function has a kink at eb = ep, a power 3/2 or 5/2.
struct Moment {
  double (*of_pair)(double ep);
  double power;
};

double CanonicalAverage(double beta, const Moment& moment) {
  const auto at = [&](Quad u) { return moment.of_pair(static_cast<double>(u * u / 2)); };
  const Quad of_u = oracle::IntegrateToRoot(at, 0, M_SQRT1_2) + oracle::Integrate(at, M_SQRT1_2, 1);
  return static_cast<double>(of_u) * std::pow(2 / beta, moment.power) *
         std::tgamma(1.5 + moment.power) / std::tgamma(1.5);
}

// Tolerance of all averages: rounding of the moments and of the root at the kink.
constexpr double kCanonicalAverageError = 1e-12;

TEST(ExchangeRate, AveragesEqualIntegralsOfTheMoments) {
  const auto current = [](double ep) { return (0.5 - 2 * ep) * PairEnergyCurrent(ep); };
  for (double beta : {0.1, 1.0, 7.0}) {
    const CanonicalAverages averages = AveragesAt(beta);
    for (const auto& [moment, average] :
         {std::pair(Moment{PairCollisionRate, 0.5}, averages.mean_f),
          {Moment{current, 2.5}, averages.mean_energy_current},
          {Moment{PairSquaredEnergyTransfer, 2.5}, averages.mean_h}}) {
      EXPECT_NEAR(CanonicalAverage(beta, moment) / average, 1, kCanonicalAverageError) << beta;
    }
  }
}

}  // namespace
}  // namespace ballpiston
