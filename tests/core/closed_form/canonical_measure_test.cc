#include "core/closed_form/canonical_measure.h"

#include "core/closed_form/kernel_moments.h"
#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"

namespace ballpiston {
namespace {

// Integral of g(eb, ep) over the canonical density, in the total energy E and u = sqrt(ep/E):
// deb dep = 2 E u dE du. The kink at eb = ep, u = 1/sqrt(2), is a power 3/2 or 5/2. E is
// integrated to 50/beta in five pieces; the rest is of the order exp(-50).
template <typename Function>
double CanonicalAverage(double beta, Function g) {
  const auto at_energy = [&](Quad energy) {
    const double e = static_cast<double>(energy);
    const auto integrand = [&](Quad q) {
      const double u = static_cast<double>(q), ep = e * u * u, eb = e * (1 - u * u);
      return CanonicalDensity(beta, eb, ep) * g(eb, ep) * 2 * e * u;
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

TEST(CanonicalMeasure, AveragesEqualIntegralsOfTheMoments) {
  for (double beta : {0.1, 1.0, 7.0}) {
    const CanonicalAverages averages = AveragesAt(beta);
    const auto current = [](double eb, double ep) { return (eb - ep) * EnergyCurrent(eb, ep); };
    EXPECT_NEAR(CanonicalAverage(beta, CollisionRate) / averages.mean_f, 1, kCanonicalAverageError);
    EXPECT_NEAR(CanonicalAverage(beta, current) / averages.mean_energy_current, 1,
                kCanonicalAverageError);
    EXPECT_NEAR(CanonicalAverage(beta, SquaredEnergyTransfer) / averages.mean_h, 1,
                kCanonicalAverageError);
  }
}

}  // namespace
}  // namespace ballpiston
