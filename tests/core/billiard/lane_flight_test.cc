// One flight in lanes against one flight of the reference, under every instruction set here.
#include "core/geometry/pair_geometry.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/core/billiard/lane_flight_test.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "core/billiard/lane_flight-inl.h"
#include "core/billiard/lane_frame.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {

void FlyOnce(const PairGeometry& geometry, const LaneFrame& from, double* out) {
  using D = hn::ScalableTag<double>;
  const D d;
  const FlightConstants<double> constants(geometry);
  const Ball<D> ball = {hn::Set(d, from.h), hn::Set(d, from.e), hn::Set(d, from.c),
                        hn::Set(d, from.s)};
  const Compass<D> compass = {hn::Set(d, from.a), hn::Set(d, from.b), hn::Set(d, from.m)};
  const auto flight = Fly(d, constants, ball);
  const auto turned = Turned(d, compass, flight);
  const hn::Vec<D> values[] = {
      flight.ball.h, flight.ball.e, flight.ball.c,
      flight.ball.s, turned.a,      turned.b,
      turned.m,      flight.length, DepthAtRightTip(d, flight.ball, turned)};
  for (const auto& value : values) *out++ = hn::GetLane(value);
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/billiard/reference_flow.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/billiard/each_target.h"

namespace ballpiston {
HWY_EXPORT(FlyOnce);

namespace {

// A ball without a piston in its way: it stands at its right wall.
PairState Alone(const PairGeometry& geometry, PairState state) {
  state.ball_speed = 1;
  state.piston = geometry.piston_right();
  state.piston_velocity = 0;
  return state;
}

// The bound of one step from a common state: hit points agree to some ulps over the cosine of the
// angle to the normal, as in the comparison of the reference with the naive flow.
void CompareFlights(const PairGeometry& geometry, int flights) {
  CounterRandom random(1, 2, 3);
  PairState start = DrawFromFlowMeasure(geometry, random);
  ReferenceFlow flow(geometry, Alone(geometry, start));
  if (flow.Step().kind != EventKind::kBallWall) return;
  for (int i = 0; i < flights; ++i) {
    const PairState before = flow.state();
    const Event event = flow.Step();
    ASSERT_EQ(event.kind, EventKind::kBallWall);
    std::array<double, 9> out;
    HWY_DYNAMIC_DISPATCH(FlyOnce)
    (geometry, FrameOfBallOnWall(before.position, before.direction), out.data());
    const LaneFrame frame = {out[0], out[1], out[2], out[3], out[4], out[5], out[6]};
    const double slack = 1e-14 / std::max(frame.s, 1e-7);
    ASSERT_NEAR((PositionInCell(frame) - flow.state().position).norm(), 0, slack) << "flight " << i;
    ASSERT_NEAR((DirectionInCell(frame) - flow.state().direction).norm(), 0, 4 * slack);
    ASSERT_NEAR(out[7], event.duration, slack);
    if (flow.state().position.x() > 0) {
      ASSERT_NEAR(out[8], 0.5 - flow.state().position.x(), slack);
    } else {
      ASSERT_EQ(out[8], 4);
    }
  }
}

TEST(LaneFlight, EndsWhereTheReferenceDoes) {
  ForEachTarget([](int64_t) {
    for (const double rho : {0.501, 0.51, 0.529561127988977, 0.6, 0.7, 0.7071}) {
      CompareFlights(*PairGeometry::Create(rho, 0.01 * PairDeltaBound(rho)), 20'000);
    }
  });
}

}  // namespace
}  // namespace ballpiston
#endif  // HWY_ONCE
