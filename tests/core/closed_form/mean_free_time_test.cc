#include "core/closed_form/mean_free_time.h"

#include "tests/core/preamble.h"

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

// The two orders of limits in the footnote. In both, rho - 1/2 and delta tend to zero together;
// delta/lambda tends to zero in the first and to infinity in the second.
TEST(MeanFreeTime, DeltaFirstThenRhoGivesTheWedge) {
  for (double gap : {1e-4, 1e-6, 1e-8}) {
    const double rho = 0.5 + gap;
    const double ratio = ScaledVolumeRatio(GeometryOf(rho, 1e-6 * Lambda(rho)));
    // The cell at rho = 1/2 + gap is smaller by 4 gap/(1 - pi/4) in relative terms.
    EXPECT_NEAR(ratio / kDeltaFirstScaledVolumeRatio, 1, 1e-5 + 20 * gap) << gap;
  }
  EXPECT_DOUBLE_EQ(kDeltaFirstScaledVolumeRatio, (4 - pi) / (4 * sqrt2));
}

TEST(MeanFreeTime, RhoFirstThenDeltaGivesTheCusp) {
  const double rho = 0.5 + 1e-14;  // lambda = 2e-7
  for (double delta : {0.1, 0.01, 1e-3}) {
    const double ratio = ScaledVolumeRatio(GeometryOf(rho, delta));
    // Corrections: the wedge's lambda/delta, and delta^2 from the volume and the arc's curvature.
    const double tolerance = 2 * Lambda(rho) / delta + delta * delta;
    EXPECT_NEAR(ratio / kRhoFirstScaledVolumeRatio, 1, tolerance) << delta;
  }
  EXPECT_DOUBLE_EQ(kRhoFirstScaledVolumeRatio, 3 * (4 - pi) / (4 * sqrt2));
}

}  // namespace
}  // namespace ballpiston
