#include "core/closed_form/mean_free_time.h"

#include "tests/core/preamble.h"
#include "tools/flows/printed_formulas.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston {
namespace {

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
