#include "core/markov/energy_distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/closed_form/kernel_moments.h"
#include "core/markov/relaxation_spectrum.h"

namespace ballpiston {
namespace {

const Generator& Fine() {
  static const Generator generator({.degree = 10, .levels = 5});
  return generator;
}

// More slow pistons than fast ones, or fewer; smooth.
EnergyDistribution Tilted(double slope) {
  return EnergyDistribution::WithDensity(Fine(),
                                         [slope](double u) { return 3 * (1 + slope * (u - 0.5)); });
}

double One(double) { return 1; }

TEST(EnergyDistribution, KeepsItsTotalProbability) {
  for (const double slope : {-2.0, 0.7, 2.0}) {
    for (const double time : {0.0, 0.1, 3.0, 100.0}) {
      EXPECT_NEAR(Tilted(slope).After(time).Average(One), 1, 1e-12) << slope << " " << time;
    }
  }
}

TEST(EnergyDistribution, StepsAddUp) {
  const EnergyDistribution two = Tilted(1.5).After(1.25).After(2.5), one = Tilted(1.5).After(3.75);
  for (const double u : {0.0, 0.3, 0.7, 0.71, 0.99, 1.0}) {
    EXPECT_NEAR(two.Density(u), one.Density(u), 1e-12) << u;
  }
}

TEST(EnergyDistribution, ForgetsWhereItBegan) {
  // exp(-0.152 * 200) is 6e-14.
  const EnergyDistribution late = Tilted(2).After(200);
  for (const double u : {0.0, 0.5, 1.0}) EXPECT_NEAR(late.Density(u), 1, 1e-11) << u;
  EXPECT_NEAR(late.MeanEnergy(), kMeanPistonEnergy, 1e-12);
  EXPECT_NEAR(EnergyDistribution::At(Fine(), 0.4).After(200).MeanEnergy(), kMeanPistonEnergy,
              1e-11);
}

// int K(u, v) density(v) dv - r(u) density(u), K being symmetric; v = s sin(phi) takes the
// singularity out, and Simpson's rule has the kink at v = u between two of its pieces.
double SlopeByQuadrature(double u, double slope) {
  const double s = std::sqrt(1 - u * u);
  const auto density = [slope](double v) { return 1 + slope * (v - 0.5); };
  const auto integrand = [&](double phi) {
    const double v = s * std::sin(phi);
    return std::max(u, v) * density(v) * std::numbers::inv_pi / std::numbers::sqrt2;
  };
  const auto simpson = [&](double a, double b) {
    constexpr int kPieces = 400;
    double sum = 0;
    for (int i = 0; i < kPieces; ++i) {
      const double left = a + (b - a) * i / kPieces, h = (b - a) / kPieces;
      sum += h / 6 * (integrand(left) + 4 * integrand(left + h / 2) + integrand(left + h));
    }
    return sum;
  };
  const double kink = u < s ? std::asin(u / s) : std::numbers::pi / 2;
  const double gain = simpson(0, kink) + simpson(kink, std::numbers::pi / 2);
  return gain - PairCollisionRate(u * u / 2) * density(u);
}

TEST(EnergyDistribution, FollowsTheKernel) {
  constexpr double kStep = 1e-4;  // central differences about t = kStep: error of order kStep
  for (const double slope : {-1.0, 2.0}) {
    const EnergyDistribution start = Tilted(slope);
    for (const double u : {0.1, 0.35, 0.6, 0.8, 0.95}) {
      const double measured = (start.After(2 * kStep).Density(u) - start.Density(u)) / (2 * kStep);
      EXPECT_NEAR(measured, SlopeByQuadrature(u, slope), 1e-4) << slope << " " << u;
    }
  }
}

TEST(EnergyDistribution, MeanEnergyIsThatOfTheRelaxationSpectrum) {
  for (const double epsilon : {0.0, 0.05, 0.4, 0.5}) {
    for (const double time : {0.5, 4.0, 20.0}) {
      EXPECT_NEAR(EnergyDistribution::At(Fine(), epsilon).After(time).MeanEnergy(),
                  RelaxationSpectrum::Get().MeanEnergy(epsilon, time).value, 1e-7);
    }
  }
}

}  // namespace
}  // namespace ballpiston
