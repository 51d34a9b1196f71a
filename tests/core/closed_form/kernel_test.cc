#include "core/closed_form/kernel.h"

#include "tests/core/preamble.h"
#include "tools/flows/printed_formulas.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston {
namespace {

Quad Positive(Quad x) { return x > 0 ? x : Quad{0}; }

Quad PairBall(double ep) { return Quad{1} / 2 - Quad{ep}; }

// The first form of eq. kernel: the sum over the piston's signs before and after.
Quad KernelOverSigns(double ep, Quad ep_out) {
  const Quad eb = PairBall(ep);
  if (ep_out >= eb) return 0;
  Quad sum = 0;
  for (int before : {1, -1}) {
    for (int after : {1, -1}) sum += Positive(after * sqrt(ep_out) - before * sqrt(Quad{ep}));
  }
  return sum / (4 * QuadPi() * sqrt(ep_out) * sqrt(eb - ep_out));
}

// Random energies: anywhere, where the ball keeps little energy, and close to (1/4, 1/4), where
// 1/2 - ep loses a bit.
TEST(Kernel, AccurateAtRandomEnergies) {
  std::mt19937_64 random(20240607);
  std::uniform_real_distribution<double> exponent(-17, 0), unit(0, 1);
  const double below = std::nextafter(0.25, 0.0);
  std::vector<std::pair<double, double>> energies = {{below, below}};  // of the piston
  for (int i = 0; i < 3000; ++i) {
    const double small = 0.5 * std::pow(10, exponent(random)),
                 share = std::pow(10, exponent(random));
    for (const double ep : {small, 0.5 - small, 0.25 - small / 2, 0.5 * unit(random)}) {
      energies.emplace_back(ep, 0.5 * unit(random));
      energies.emplace_back(ep, (0.5 - ep) * (1 - share / 10));
    }
  }
  for (const auto& [ep, out] : energies) {
    EXPECT_LE(RelativeError(PairKernel(ep, out), KernelOverSigns(ep, out)), kKernelRelativeError)
        << ep << " " << out;
  }
}

TEST(Kernel, ValuesAtTheEdgesOfItsDomain) {
  // Beyond the ball's energy.
  for (const double value : {PairKernel(0.1, 0.4), PairKernel(0.1, 0.45), PairKernel(0.5, 1e-12)}) {
    EXPECT_EQ(value, 0);
  }
  // Where the piston ends at rest.
  EXPECT_EQ(PairKernel(0.1, 0), HUGE_VAL);
  EXPECT_DOUBLE_EQ(PairKernel(0, 0), 1 / (M_PI * M_SQRT2));
  EXPECT_DOUBLE_EQ(PairKernel(0, 1e-320), 1 / (M_PI * M_SQRT2));
  EXPECT_DOUBLE_EQ(PairKernel(0.25, 1e-310), 1 / (2 * M_PI * std::sqrt(1e-310)));
}

// ---- moments ----

double ErrorOfMoments(double ep) {
  const Quad eb = PairBall(ep);
  return std::max(
      {RelativeError(PairCollisionRate(ep), CollisionRateAsPrinted(eb, Quad{ep}, QuadPi())),
       RelativeError(PairEnergyCurrent(ep), EnergyCurrentAsPrinted(eb, Quad{ep}, QuadPi())),
       RelativeError(PairSquaredEnergyTransfer(ep),
                     SquaredTransferAsPrinted(eb, Quad{ep}, QuadPi()))});
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

// Random energies: anywhere, next to the ends and the middle, where the printed arcsine is steep,
// and where the current passes through its zero.
TEST(Kernel, MomentsAreAccurateForEveryEnergy) {
  std::mt19937_64 random(20240605);
  std::uniform_real_distribution<double> exponent(-15, 0);
  const Quad zero = CurrentZero();
  const auto nearest = static_cast<double>(zero / 2);
  std::vector<double> energies = {
      0.0, 1e-300, 0.25, 0.5, std::nextafter(nearest, 0.0), nearest, std::nextafter(nearest, 1.0)};
  for (int i = 1; i < 4000; ++i) energies.push_back(i / 8000.0);
  for (double gap = 1e-16; gap < 1e-2; gap *= 3) energies.push_back(0.25 - gap);
  for (int i = 0; i < 2000; ++i) {
    const double small = 0.5 * std::pow(10, exponent(random));
    for (double ep : {small, 0.5 - small, 0.25 + small / 2, 0.25 - small / 2}) {
      energies.push_back(ep);
    }
    for (const double offset : {-small / 5, small / 5}) {
      energies.push_back(static_cast<double>(zero * (1 + Quad{offset}) / 2));
    }
  }
  double worst = 0;
  for (double ep : energies) worst = std::max(worst, ErrorOfMoments(ep));
  EXPECT_LE(worst, kKernelMomentsRelativeError);
  EXPECT_GT(worst, 1e-16);  // the comparison sees rounding
}

// ---- distribution ----

// pi times the integral of W from 0 to ep_out, calculated by hand: the arcsine part up to ep, the
// root's part beyond.
Quad IntegratedKernel(Quad eb, Quad ep, Quad ep_out) {
  const Quad arc_end = std::min({eb, ep, ep_out});
  Quad sum = eb > 0 ? sqrt(ep) * asin(sqrt(arc_end / eb)) : Quad{0};
  if (eb > ep && ep_out > ep) sum += sqrt(eb - ep) - sqrt(eb - std::min(eb, ep_out));
  return sum;
}

double ErrorOf(double ep, double ep_out) {
  const Quad eb = PairBall(ep);
  const Quad exact = IntegratedKernel(eb, ep, ep_out) / IntegratedKernel(eb, ep, eb);
  return RelativeError(KernelDistribution(ep).Below(ep_out), exact);
}

// Anywhere, next to the ends and the middle; and where the ball keeps little energy. There F is 1
// minus a root, so an error of an ulp of 1/2 in the ball's remaining energy would change F by 1e-8.
TEST(Kernel, DistributionIsAccurateAtRandomEnergies) {
  std::mt19937_64 random(20240701);
  std::uniform_real_distribution<double> exponent(-14, 0), smaller(-17, -1), unit(0, 0.5);
  double worst = 0, worst_rate = 0;
  for (int i = 0; i < 3000; ++i) {
    const double small = 0.5 * std::pow(10, exponent(random));
    const double share = std::pow(10, exponent(random));
    for (const double ep : {small, 0.25 - small / 2, 0.25 + small / 2, 0.5 - small}) {
      const double eb = 0.5 - ep;
      for (const double out : {eb * share, eb * (1 - share), ep * (1 + share), ep * (1 - share)}) {
        worst = std::max(worst, ErrorOf(ep, out));
      }
      worst_rate = std::max(
          worst_rate, RelativeError(KernelDistribution(ep).CollisionRate(),
                                    CollisionRateAsPrinted(PairBall(ep), Quad{ep}, QuadPi())));
    }
    for (const double ep : {0.25 - 0.25 * std::pow(10, smaller(random)), unit(random)}) {
      worst = std::max(worst, ErrorOf(ep, (0.5 - ep) * (1 - std::pow(10, smaller(random)))));
    }
  }
  EXPECT_LE(worst, kKernelDistributionRelativeError);
  EXPECT_LE(worst_rate, kKernelDistributionRelativeError);
  EXPECT_GT(worst, 1e-16);  // the comparison sees rounding
}

TEST(Kernel, DistributionRisesFromZeroToOne) {
  for (const double ep :
       {0.0, 1e-300, 1e-12, 0.03, 0.2499999999, 0.25, 0.26, 0.49, 0.5 - 0x1p-54}) {
    const KernelDistribution law(ep);
    const double eb = 0.5 - ep;
    EXPECT_EQ(law.Below(0), 0) << ep;
    EXPECT_EQ(law.Below(std::nextafter(eb, 1.0)), 1) << ep;
    EXPECT_EQ(law.Below(0.5), 1) << ep;
    EXPECT_NEAR(law.Below(eb), 1, 1e-8) << ep;  // 1/2 - ep is rounded: the root of an ulp
    double before = 0;
    for (int i = 1; i <= 10'000; ++i) {
      const double now = law.Below(eb * i / 10'000);
      // On either side of ep the two forms may differ by an ulp.
      EXPECT_GE(now, before - 0x1p-52) << ep << " " << i;
      before = now;
    }
  }
  EXPECT_EQ(KernelDistribution(0.5).Below(0), 1);  // a ball at rest gives the piston no energy
}

}  // namespace
}  // namespace ballpiston
