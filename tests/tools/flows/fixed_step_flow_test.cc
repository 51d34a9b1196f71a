#include "tools/flows/fixed_step_flow.h"

#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

TEST(FixedStepFlow, EnergyStaysExact) {
  CounterRandom random(3, 0, 0);
  FixedStepFlow flow(kPaperPair, DrawFromFlowMeasure(kPaperPair, random), 1e-3);
  for (int i = 0; i < 30'000; ++i) {
    const FixedSteps done = flow.Advance(1000);
    ASSERT_FALSE(done.lost);
    if (done.ball_piston) flow.ExchangeComponents();
    // Each repair has an error of a few ulps. 3e4 repairs with errors in one direction give 1e-11.
    ASSERT_LE(EnergyError(flow.state()), 1e-11) << "after " << i << " repairs";
  }
}

TEST(FixedStepFlow, ABallBeyondATipIsLost) {
  const PairGeometry cusps = GeometryOf(0.5001, 0.2);
  FixedStepFlow flow(
      cusps,
      {.position = {0, 0}, .direction = {-1, 0}, .ball_speed = 1, .piston = cusps.piston_right()},
      0.51);
  EXPECT_TRUE(flow.Advance(1).lost);
}

}  // namespace
}  // namespace ballpiston
