#include "core/closed_form/mean_free_time.h"

#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"
#include "tools/flows/printed_formulas.h"

namespace ballpiston {
namespace {

using std::numbers::pi;
using std::numbers::sqrt2;

TEST(MeanFreeTime, RareLimitRateIsTheLimitOfTheRate) {
  for (double rho : {0.501, kPaperRho, 0.6, 0.65, 0.7}) {
    for (double fraction : {1e-3, 1e-6, 1e-9}) {
      const double delta = fraction * PairDeltaBound(rho);
      const double rate = 1 / (MeanFreeTimesOf(GeometryOf(rho, delta)).ball_piston * delta * delta);
      // The leading correction, a few delta/lambda, is the reason for the tolerance's second term.
      EXPECT_NEAR(rate / RareLimitRate(rho), 1, 1e-13 + 4 * delta / Lambda(rho)) << rho;
    }
  }
}

// delta^2 |G|/|dG_bp|.
double ScaledVolumeRatio(double rho, double delta) {
  return delta * delta * MeanFreeTimesOf(GeometryOf(rho, delta)).ball_piston / 4;
}

// The limit of rho -> 1/2 after that of delta -> 0. In the other order it is three times as large.
constexpr double kDeltaFirst = (4 - pi) / (4 * sqrt2);

// The two orders of limits in the footnote. In both, rho - 1/2 and delta tend to zero together;
// delta/lambda tends to zero in the first and to infinity in the second.
TEST(MeanFreeTime, DeltaFirstThenRhoGivesTheWedge) {
  for (double gap : {1e-4, 1e-6, 1e-8}) {
    const double rho = 0.5 + gap;
    const double ratio = ScaledVolumeRatio(rho, 1e-6 * Lambda(rho));
    // The cell at rho = 1/2 + gap is smaller by 4 gap/(1 - pi/4) in relative terms.
    EXPECT_NEAR(ratio / kDeltaFirst, 1, 1e-5 + 20 * gap) << gap;
  }
}

TEST(MeanFreeTime, RhoFirstThenDeltaGivesTheCusp) {
  const double rho = 0.5 + 1e-14;  // lambda = 2e-7
  for (double delta : {0.1, 0.01, 1e-3}) {
    const double ratio = ScaledVolumeRatio(rho, delta);
    // Corrections: the wedge's lambda/delta, and delta^2 from the volume and the arc's curvature.
    const double tolerance = 2 * Lambda(rho) / delta + delta * delta;
    EXPECT_NEAR(ratio / (3 * kDeltaFirst), 1, tolerance) << delta;
  }
}

// ---- at given energies ----

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

// Eq. intcnuep. With ep = u^2/2 the weight becomes du; the cut at ep = 1/4 lies at u = 1/sqrt(2),
// where phi has a kink (d^(3/2)).
TEST(MeanFreeTime, PhiAveragesToOne) {
  const auto phi = [](Quad u) { return Phi(std::pow(static_cast<double>(u), 2) / 2); };
  const Quad below = oracle::IntegrateToRoot(phi, 0, M_SQRT1_2);
  const Quad above = oracle::Integrate(phi, M_SQRT1_2, 1);
  // The only remaining error is the rounding of phi in double.
  EXPECT_NEAR(static_cast<double>(below + above), 1, 1e-14);
}

TEST(MeanFreeTime, ConditionalMeanFreeTimeIsTauOverPhi) {
  const PairGeometry geometry = PaperGeometry(0.1);
  const double tau = MeanFreeTimesOf(geometry).ball_piston;
  for (double ep : {1e-300, 0.125, 0.25, 0.375, 0.5 - 1e-16}) {
    EXPECT_DOUBLE_EQ(ConditionalMeanFreeTime(geometry, ep) * Phi(ep), tau);
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

}  // namespace
}  // namespace ballpiston
