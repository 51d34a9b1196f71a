#include "core/closed_form/exchange_rate.h"

#include "core/closed_form/kernel.h"
#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"

namespace ballpiston {
namespace {

// The canonical density of the energies of a pair, eq. canmeasure.
double CanonicalDensity(double beta, double eb, double ep) {
  return beta * std::sqrt(beta / (M_PI * ep)) * std::exp(-beta * (eb + ep));
}

// A function of (eb, ep) with the total energy E is that of the energies over 2 E, times a power of
// 2 E.
struct Moment {
  std::function<double(double ep)> of_pair;
  double power;
};

// Integral of the moment over the canonical density, in the total energy E and u = sqrt(ep/E):
// deb dep = 2 E u dE du. The kink at eb = ep, u = 1/sqrt(2), is a power 3/2 or 5/2. E is
// integrated to 50/beta in five pieces; the rest is of the order exp(-50).
double CanonicalAverage(double beta, const Moment& moment) {
  const auto at_energy = [&](Quad energy) {
    const double e = static_cast<double>(energy);
    const auto integrand = [&](Quad q) {
      const double u = static_cast<double>(q), ep = e * u * u, eb = e * (1 - u * u);
      return CanonicalDensity(beta, eb, ep) * std::pow(2 * e, moment.power) *
             moment.of_pair(u * u / 2) * 2 * e * u;
    };
    return oracle::IntegrateToRoot(integrand, 0, M_SQRT1_2) +
           oracle::Integrate(integrand, M_SQRT1_2, 1);
  };
  Quad sum = 0;
  for (int piece = 0; piece < 5; ++piece) {
    // E = s^2 takes the square root out of the energy's density.
    const double from = std::sqrt(10 * piece / beta);
    const double to = std::sqrt(10 * (piece + 1) / beta);
    sum += oracle::Integrate([&](Quad s) { return 2 * s * at_energy(s * s); }, from, to);
  }
  return static_cast<double>(sum);
}

// Tolerance of all averages: rounding of some 1e4 doubles of one sign, and exp(-50).
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
