#include "core/closed_form/kernel_moments.h"

#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"
#include "tools/flows/printed_formulas.h"

namespace ballpiston {
namespace {

double WorstError(double f, double j, double h, Quad eb, Quad ep) {
  return std::max({RelativeError(f, CollisionRateAsPrinted(eb, ep, QuadPi())),
                   RelativeError(j, EnergyCurrentAsPrinted(eb, ep, QuadPi())),
                   RelativeError(h, SquaredTransferAsPrinted(eb, ep, QuadPi()))});
}

double ErrorOfMoments(double eb, double ep) {
  return WorstError(CollisionRate(eb, ep), EnergyCurrent(eb, ep), SquaredEnergyTransfer(eb, ep), eb,
                    ep);
}

double ErrorOfPairMoments(double ep) {
  return WorstError(PairCollisionRate(ep), PairEnergyCurrent(ep), PairSquaredEnergyTransfer(ep),
                    Quad{1} / 2 - Quad{ep}, ep);
}

// The moment of order n of the energy transfer as an integral over the kernel, W with
// ep_out = eb sin^2 t, cut where the maximum in W changes sides.
Quad MomentByQuadrature(int n, double eb, double ep) {
  const auto integrand = [&](Quad t) {
    const Quad out = Quad{eb} * Sin(t) * Sin(t);
    Quad power = 1;
    for (int k = 0; k < n; ++k) power *= out - Quad{ep};
    return power * std::max(Sqrt(out), Sqrt(Quad{ep})) / QuadPi();
  };
  const Quad cut = ep < eb ? Asin(Sqrt(Quad{ep} / Quad{eb})) : QuadPi() / 2;
  return oracle::Integrate(integrand, 0, cut) + oracle::Integrate(integrand, cut, QuadPi() / 2);
}

// The zero of j in ep/(eb + ep), by bisection of the printed formula.
Quad CurrentZero() {
  Quad low = Quad{3} / 10;
  Quad high = Quad{4} / 10;
  for (int i = 0; i < 110; ++i) {
    const Quad middle = (low + high) / 2;
    (EnergyCurrentAsPrinted(1 - middle, middle, QuadPi()) > 0 ? low : high) = middle;
  }
  return low;
}

// Anywhere, next to the ends and the middle, and where the printed arcsine is steep.
TEST(KernelMoments, AccurateForEveryEnergy) {
  std::mt19937_64 random(20240605);
  std::uniform_real_distribution<double> exponent(-14, 0);
  std::vector<double> energies = {0.0, 1e-300, 0.25, 0.5};
  for (int i = 1; i < 4000; ++i) energies.push_back(i / 8000.0);
  for (int i = 0; i < 2000; ++i) {
    const double small = 0.5 * std::pow(10, exponent(random));
    for (double ep : {small, 0.5 - small, 0.25 + small / 2, 0.25 - small / 2}) {
      energies.push_back(ep);
    }
  }
  double worst = 0, worst_printed = 0;
  for (double gap = 1e-16; gap < 1e-2; gap *= 3) {
    const double ep = 0.25 - gap;
    energies.push_back(ep);
    const Quad exact = CollisionRateAsPrinted(Quad{1} / 2 - Quad{ep}, Quad{ep}, QuadPi());
    worst_printed =
        std::max(worst_printed, RelativeError(CollisionRateAsPrinted(0.5 - ep, ep, M_PI), exact));
  }
  for (double ep : energies) {
    worst = std::max({worst, ErrorOfPairMoments(ep), ErrorOfMoments(0.5 - ep, ep),
                      ErrorOfMoments(800 * (0.5 - ep), 800 * ep)});
  }
  EXPECT_LE(worst, kKernelMomentsRelativeError);
  EXPECT_GT(worst_printed, 1e-12);
}

TEST(KernelMoments, CurrentIsAccurateThroughItsZero) {
  std::mt19937_64 random(20240606);
  std::uniform_real_distribution<double> exponent(-15, -1);
  std::uniform_real_distribution<double> energy_exponent(-3, 3);
  const Quad zero = CurrentZero();
  double worst = 0;
  double worst_printed = 0;
  for (int i = 0; i < 2000; ++i) {
    const double offset = std::pow(10, exponent(random)) * (i % 2 == 0 ? 1 : -1);
    const double ep = static_cast<double>(zero * (1 + Quad{offset}) / 2);
    worst = std::max(worst, ErrorOfPairMoments(ep));
    worst_printed =
        std::max(worst_printed,
                 RelativeError(EnergyCurrentAsPrinted(0.5 - ep, ep, M_PI),
                               EnergyCurrentAsPrinted(Quad{1} / 2 - Quad{ep}, Quad{ep}, QuadPi())));
    const double eb = std::pow(10, energy_exponent(random));
    worst = std::max(worst, ErrorOfMoments(eb, static_cast<double>(zero / (1 - zero) *
                                                                   (1 + Quad{offset}) * Quad{eb})));
  }
  const double nearest = static_cast<double>(zero / 2);
  for (double ep : {std::nextafter(nearest, 0.0), nearest, std::nextafter(nearest, 1.0)}) {
    worst = std::max(worst, ErrorOfPairMoments(ep));
  }
  EXPECT_LE(worst, kKernelMomentsRelativeError);
  EXPECT_GT(worst_printed, 1e-3);  // the printed formula fails at these points
}

TEST(KernelMoments, CurrentFlowsToTheSlowPiston) {
  EXPECT_NEAR(kCurrentZeroRatio, static_cast<double>(CurrentZero() / (1 - CurrentZero())), 1e-16);
  for (double ratio = 0; ratio < 3; ratio += 0.003) {
    EXPECT_EQ(EnergyCurrent(0.7, 0.7 * ratio) > 0, ratio < kCurrentZeroRatio) << ratio;
    EXPECT_GT(CollisionRate(0.7, 0.7 * ratio), 0);
    EXPECT_GT(SquaredEnergyTransfer(0.7, 0.7 * ratio), 0);
  }
  EXPECT_EQ(CollisionRate(0, 0), 0);
  EXPECT_EQ(EnergyCurrent(0, 0), 0);
  EXPECT_EQ(SquaredEnergyTransfer(0, 0), 0);
}

TEST(KernelMoments, AreIntegralsOfTheKernel) {
  for (double eb : {0.01, 0.3, 0.5, 2.0}) {
    for (double ep : {0.0, 1e-6, 0.05, 0.2, 0.5, 3.0}) {
      EXPECT_LE(RelativeError(CollisionRate(eb, ep), MomentByQuadrature(0, eb, ep)),
                kKernelMomentsRelativeError);
      EXPECT_LE(RelativeError(EnergyCurrent(eb, ep), MomentByQuadrature(1, eb, ep)),
                kKernelMomentsRelativeError);
      EXPECT_LE(RelativeError(SquaredEnergyTransfer(eb, ep), MomentByQuadrature(2, eb, ep)),
                kKernelMomentsRelativeError);
    }
  }
}

}  // namespace
}  // namespace ballpiston
