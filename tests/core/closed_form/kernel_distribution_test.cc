#include "core/closed_form/kernel_distribution.h"

#include "core/closed_form/kernel.h"
#include "core/closed_form/kernel_moments.h"
#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"
#include "tools/flows/printed_formulas.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston {
namespace {

// pi times the integral of W from 0 to ep_out, calculated by hand: the arcsine part up to ep, the
// root's part beyond.
Quad IntegratedKernel(Quad eb, Quad ep, Quad ep_out) {
  const Quad arc_end = std::min({eb, ep, ep_out});
  Quad sum = eb > 0 ? Sqrt(ep) * Asin(Sqrt(arc_end / eb)) : Quad{0};
  if (eb > ep && ep_out > ep) sum += Sqrt(eb - ep) - Sqrt(eb - std::min(eb, ep_out));
  return sum;
}

Quad ExactBelow(Quad eb, Quad ep, Quad ep_out) {
  return IntegratedKernel(eb, ep, ep_out) / IntegratedKernel(eb, ep, eb);
}

Quad PairBall(double ep) { return Quad{1} / 2 - Quad{ep}; }

// The error of F of the pair and, if 1/2 - ep is exact, of F of two energies.
double WorstError(double ep, double ep_out) {
  const double eb = 0.5 - ep;
  return std::max(
      RelativeError(KernelDistribution::OfPair(ep).Below(ep_out),
                    ExactBelow(PairBall(ep), ep, ep_out)),
      RelativeError(KernelDistribution(eb, ep).Below(ep_out), ExactBelow(eb, ep, ep_out)));
}

// Anywhere, next to the ends and the middle; and where the ball keeps little energy. There F is 1
// minus a root, so an error of an ulp of 1/2 in the ball's remaining energy would change F by 1e-8.
TEST(KernelDistribution, AccurateAtRandomEnergies) {
  std::mt19937_64 random(20240701);
  std::uniform_real_distribution<double> exponent(-14, 0), smaller(-17, -1), unit(0, 0.5);
  double worst = 0, worst_rate = 0;
  for (int i = 0; i < 3000; ++i) {
    const double small = 0.5 * std::pow(10, exponent(random));
    const double share = std::pow(10, exponent(random));
    for (const double ep : {small, 0.25 - small / 2, 0.25 + small / 2, 0.5 - small}) {
      const double eb = 0.5 - ep;
      for (const double out : {eb * share, eb * (1 - share), ep * (1 + share), ep * (1 - share)}) {
        worst = std::max(worst, WorstError(ep, out));
      }
      worst_rate = std::max(
          worst_rate, RelativeError(KernelDistribution::OfPair(ep).CollisionRate(),
                                    CollisionRateAsPrinted(PairBall(ep), Quad{ep}, QuadPi())));
    }
    for (const double ep : {0.25 - 0.25 * std::pow(10, smaller(random)), unit(random)}) {
      worst = std::max(worst, WorstError(ep, (0.5 - ep) * (1 - std::pow(10, smaller(random)))));
    }
  }
  EXPECT_LE(worst, kKernelDistributionRelativeError);
  EXPECT_LE(worst_rate, kKernelDistributionRelativeError);
  EXPECT_GT(worst, 1e-16);  // the comparison sees rounding
}

TEST(KernelDistribution, RisesFromZeroToOne) {
  for (const double ep :
       {0.0, 1e-300, 1e-12, 0.03, 0.2499999999, 0.25, 0.26, 0.49, 0.5 - 0x1p-54}) {
    const KernelDistribution law = KernelDistribution::OfPair(ep);
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
  EXPECT_EQ(KernelDistribution(0.3, 0.1).Below(0.3), 1);
  EXPECT_EQ(KernelDistribution(0, 0.5).Below(0), 1);  // a ball at rest gives the piston no energy
  EXPECT_EQ(KernelDistribution::OfPair(0.5).Below(0), 1);
}

TEST(KernelDistribution, SlopeIsTheKernelOverItsRate) {
  for (const double eb : {0.01, 0.3, 2.0}) {
    for (const double ep : {0.0, 1e-6, 0.05, 0.2, 0.5, 3.0}) {
      const KernelDistribution law(eb, ep);
      for (const double share : {0.01, 0.2, 0.6, 0.95}) {
        const double out = share * eb, step = 1e-5 * out * (1 - share);
        if (std::fabs(out - ep) <= step) continue;
        const double slope = (law.Below(out + step) - law.Below(out - step)) / (2 * step);
        // The third derivative times step^2, and rounding over step.
        EXPECT_NEAR(slope * law.CollisionRate() / Kernel(eb, ep, out), 1, 1e-6)
            << eb << " " << ep << " " << out;
      }
    }
  }
}

}  // namespace
}  // namespace ballpiston
