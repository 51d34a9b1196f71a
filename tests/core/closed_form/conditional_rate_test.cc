#include "core/closed_form/conditional_rate.h"

#include "core/closed_form/mean_free_time.h"
#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"
#include "tools/flows/printed_formulas.h"

namespace ballpiston {
namespace {

double ErrorOfPhi(double ep) {
  const Quad eb = Quad{1} / 2 - Quad{ep};
  return RelativeError(Phi(ep), 4 * CollisionRateAsPrinted(eb, Quad{ep}, QuadPi()));
}

TEST(ConditionalRate, AccurateForEveryEnergy) {
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
TEST(ConditionalRate, AveragesToTheUnconditionalRate) {
  const auto phi = [](Quad u) { return Phi(std::pow(static_cast<double>(u), 2) / 2); };
  const Quad below = oracle::IntegrateToRoot(phi, 0, M_SQRT1_2);
  const Quad above = oracle::Integrate(phi, M_SQRT1_2, 1);
  // The only remaining error is the rounding of phi in double.
  EXPECT_NEAR(static_cast<double>(below + above), 1, 1e-14);
}

TEST(ConditionalRate, ConditionalMeanFreeTimeIsTauOverPhi) {
  const PairGeometry geometry = PaperGeometry(0.1);
  const double tau = MeanFreeTimesOf(geometry).ball_piston;
  for (double ep : {1e-300, 0.125, 0.25, 0.375, 0.5 - 1e-16}) {
    EXPECT_DOUBLE_EQ(ConditionalMeanFreeTime(geometry, ep) * Phi(ep), tau);
  }
}

// A small delta. The ball meets a resting piston if the piston is within delta of the tip, which is
// delta/(lambda + 2 delta) of the volume. A resting ball waits until the piston has gone to its far
// wall and back, 2 (lambda + 2 delta) at speed 1. Both hold to first order in delta.
TEST(ConditionalRate, AtRestOnlyTheVisitedPartCounts) {
  const double delta = 1e-6;
  const PairGeometry geometry = PaperGeometry(delta);
  const double tau = MeanFreeTimesOf(geometry).ball_piston, lambda = geometry.lambda();
  EXPECT_NEAR(ConditionalMeanFreeTime(geometry, 0) * Phi(0) / tau, delta / (lambda + 2 * delta),
              10 * delta * delta);
  EXPECT_NEAR(ConditionalMeanFreeTime(geometry, 0.5), 2 * lambda, 10 * delta);
}

}  // namespace
}  // namespace ballpiston
