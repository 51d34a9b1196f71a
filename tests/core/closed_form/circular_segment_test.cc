#include "core/closed_form/circular_segment.h"

#include "tests/core/preamble.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston {
namespace {

TEST(CircularSegment, AngleMinusSineIsAccurate) {
  double worst = 0;
  // From 1e-8, where the quadruple difference has 18 digits left.
  for (double angle = 1e-8; angle < 2 * std::numbers::pi; angle *= 1.01) {
    const double error = RelativeError(AngleMinusSine(angle), Quad{angle} - sin(Quad{angle}));
    worst = std::max(worst, error);
  }
  EXPECT_LE(worst, kAngleMinusSineRelativeError);
}

TEST(CircularSegment, AngleMinusSineOfATinyAngleIsItsCube) {
  EXPECT_EQ(AngleMinusSine(0), 0);
  // One rounding of the cube and one of the quotient.
  EXPECT_NEAR(AngleMinusSine(1e-50), 1e-150 / 6, 1e-165);
}

}  // namespace
}  // namespace ballpiston
