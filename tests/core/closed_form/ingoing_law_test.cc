#include "core/closed_form/ingoing_law.h"

#include "core/closed_form/kernel.h"
#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"

namespace ballpiston {
namespace {

constexpr double kEnergies[] = {0.0,          1e-300, 1e-16, 1e-8,         1.0 / 3200,
                                0.01,         0.125,  0.249, 0.2499999999, 0.25,
                                0.2500000001, 0.251,  0.375, 0.49,         0.5};

// eq. falpha with n = 1, not normalised.
Quad Weight(double ep, int sigma, Quad alpha) {
  const Quad value = sqrt(Quad{1} / 2 - Quad{ep}) * cos(alpha) - sigma * sqrt(Quad{ep});
  return value > 0 ? value : Quad{0};
}

Quad Edge(double ep, int sigma) {
  if (ep >= 0.25) return sigma > 0 ? Quad{0} : QuadPi();
  const Quad ratio = sqrt(Quad{ep} / (Quad{1} / 2 - Quad{ep}));
  return QuadPi() / 2 - sigma * asin(ratio);
}

// Integral of g(alpha, sigma) times the weight over both signs.
template <typename Function>
Quad OverTheCircle(double ep, Function g) {
  Quad sum = 0;
  for (int sigma : {1, -1}) {
    const Quad edge = Edge(ep, sigma);
    sum +=
        oracle::Integrate([&](Quad a) { return g(a, sigma) * Weight(ep, sigma, a); }, -edge, edge);
  }
  return sum;
}

Quad Norm(double ep) {
  return OverTheCircle(ep, [](Quad, int) { return 1; });
}

TEST(IngoingLaw, BinProbabilityIsTheIntegralOfTheDensity) {
  std::mt19937_64 random(20240609);
  std::uniform_real_distribution<double> unit(0, 1);
  for (double ep : kEnergies) {
    const IngoingLaw law(ep);
    const Quad norm = Norm(ep);
    for (int sigma : {1, -1}) {
      const double edge = law.AlphaMax(sigma);
      for (int i = 0; i < 100; ++i) {
        const double a0 = edge * (2 * unit(random) - 1);
        const double a1 = a0 + (edge - a0) * unit(random);
        const Quad exact =
            oracle::Integrate([&](Quad a) { return Weight(ep, sigma, a); }, a0, a1) / norm;
        // The oracle uses the exact edge, the law the rounded edge: see the header.
        const double from_edge = std::min(edge - std::abs((a0 + a1) / 2), edge);
        const double tolerance =
            kIngoingLawRelativeError + (edge > 0 ? 1e-15 * edge / from_edge : 0);
        EXPECT_LE(RelativeError(law.BinProbability(sigma, a0, a1), exact), tolerance)
            << ep << " " << sigma << " " << a0 << " " << a1;
      }
    }
  }
}

TEST(IngoingLaw, OnlyThePermittedIntervalCounts) {
  const IngoingLaw law(0.125);
  const double edge = law.AlphaMax(1);
  EXPECT_EQ(law.BinProbability(1, edge, M_PI), 0);
  EXPECT_EQ(law.BinProbability(1, -M_PI, -edge), 0);
  EXPECT_EQ(law.BinProbability(1, -M_PI, M_PI), law.SigmaProbability(1));
  EXPECT_EQ(IngoingLaw(0.25).SigmaProbability(1), 0);
  EXPECT_EQ(IngoingLaw(0.4).SigmaProbability(1), 0);
  EXPECT_EQ(IngoingLaw(0.4).BinProbability(1, -0.1, 0.1), 0);
}

TEST(IngoingLaw, IntervalsAndMeansAreThoseOfTheDensity) {
  for (double ep : kEnergies) {
    const IngoingLaw law(ep);
    const Quad norm = Norm(ep);
    for (int sigma : {1, -1}) {
      const Quad edge = Edge(ep, sigma);
      EXPECT_LE(RelativeError(law.AlphaMax(sigma), edge), 1e-15) << ep << " " << sigma;
      const auto weight = [&](Quad a) { return Weight(ep, sigma, a); };
      EXPECT_LE(
          RelativeError(law.SigmaProbability(sigma), oracle::Integrate(weight, -edge, edge) / norm),
          kIngoingLawRelativeError)
          << ep << " " << sigma;
    }
    const Quad cosine = OverTheCircle(ep, [](Quad a, int) { return cos(a); }) / norm;
    const Quad sign = OverTheCircle(ep, [](Quad, int sigma) { return sigma; }) / norm;
    // An absolute error, because both integrals cancel where they are small. The closed forms do
    // not.
    EXPECT_NEAR(law.MeanCosAlpha(), static_cast<double>(cosine), 1e-14) << ep;
    EXPECT_NEAR(law.MeanSigma(), static_cast<double>(sign), 1e-14) << ep;
  }
}

}  // namespace
}  // namespace ballpiston
