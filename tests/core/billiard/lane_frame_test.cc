#include "core/billiard/lane_frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/billiard/reference_flow.h"
#include "core/sampling/invariant_measure.h"

namespace ballpiston {
namespace {

// Every wall hit of an orbit, so all discs and directions: there and back to some ulps.
TEST(LaneFrame, ThereAndBackIsTheSamePlace) {
  for (const double rho : {0.501, 0.529561127988977, 0.7}) {
    const PairGeometry geometry = *PairGeometry::Create(rho, 0.3 * PairDeltaBound(rho));
    CounterRandom random(1, 2, 3);
    ReferenceFlow flow(geometry, DrawFromCollisionMeasure(geometry, random));
    for (int i = 0; i < 10'000; ++i) {
      const Event event = flow.Step();
      if (event.kind == EventKind::kBallPiston) flow.ExchangeComponents();
      if (event.kind != EventKind::kBallWall) continue;
      const PairState& state = flow.state();
      const LaneFrame frame = FrameOfBallOnWall(state.position, state.direction);
      ASSERT_NEAR((PositionInCell(frame) - state.position).norm(), 0, 1e-14);
      ASSERT_NEAR((DirectionInCell(frame) - state.direction).norm(), 0, 1e-15);
      ASSERT_NEAR(frame.h * frame.h + frame.e * frame.e, 0.5, 1e-15);
      ASSERT_GE(frame.s, 0);
      ASSERT_EQ(std::fabs(frame.a) + std::fabs(frame.b) + std::fabs(frame.m), 3);
    }
  }
}

}  // namespace
}  // namespace ballpiston
