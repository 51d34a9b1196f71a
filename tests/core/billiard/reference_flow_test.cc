#include "core/billiard/event_flow.h"
#include "core/sampling/collision_surface.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// From cusps over the paper's cell to a nearly vanished one, from the deepest piston to a rare one.
std::vector<PairGeometry> GeometriesOfFlows() {
  std::vector<PairGeometry> geometries;
  for (const double rho : {0.5 + 1e-9, 0.5 + 1e-4, 0.501, kPaperRho, 0.6, 0.7, 0.7071}) {
    for (const double share : {1.0, 0.3, 1e-2, 1e-5}) {
      geometries.push_back(GeometryAtShare(rho, share));
    }
  }
  return geometries;
}

// The depth inside a disc to which rounding may put a ball: an ulp of its position in a cell, some
// more where two discs are nearly tangent (2.1e-15 observed at rho = 0.5001, aiming exactly at a
// tip). An orbit that leaves through a tip is outside by 1e-3 or more a few events later.
constexpr double kSlack = 1e-14;

Event StepAndExchange(ReferenceFlow& flow) {
  const Event event = flow.Step();
  if (event.kind == EventKind::kBallPiston) flow.ExchangeComponents();
  return event;
}

// Speeds carry an ulp each, the squared length of the direction a few: bounded, no drift. In the
// wedge between tip and piston an orbit could get stuck: only a few events without duration may
// follow each other there.
TEST(ReferenceFlow, OrbitsKeepTheirEnergyAndStayBetweenWallsAndPiston) {
  for (const PairGeometry& geometry : GeometriesOfFlows()) {
    SCOPED_TRACE(absl::StrCat("rho ", geometry.rho(), " delta ", geometry.delta()));
    for (const uint64_t sample : {1, 2}) {
      CounterRandom random(17, 0, sample);
      ReferenceFlow flow(geometry, DrawFromFlowMeasure(geometry, random));
      int standing = 0;
      for (int i = 0; i < 100'000; ++i) {
        const Event event = StepAndExchange(flow);
        const PairState& state = flow.state();
        ASSERT_NE(event.kind, EventKind::kEscape) << "event " << i;
        ASSERT_GE(event.duration, 0);
        ASSERT_LE(EnergyError(state), 2e-15) << "event " << i;
        ASSERT_TRUE(InsideCell(geometry, state.position, kSlack)) << "event " << i;
        ASSERT_LE(state.position.x(), state.piston + 1e-15) << "event " << i;
        ASSERT_GE(state.piston, geometry.piston_left() - 1e-15);
        ASSERT_LE(state.piston, geometry.piston_right() + 1e-15);
        standing = event.duration > 0 ? 0 : standing + 1;
        ASSERT_LT(standing, 20) << "event " << i;
      }
    }
  }
}

// With the piston out of their way; and one that arrives at the tip together with a piston.
TEST(ReferenceFlow, BallsAimedAtTipsStayInTheCell) {
  std::vector<std::pair<PairGeometry, PairState>> starts;
  for (const PairGeometry& geometry : GeometriesOfFlows()) {
    for (const double offset : {0.0, 1e-17, 1e-16, 1e-14, 1e-10, 1e-6, 1e-3}) {
      for (const double angle : {-offset, offset}) {
        starts.push_back({geometry,
                          {.position = {0, 0},
                           .direction = {-std::cos(angle), std::sin(angle)},
                           .ball_speed = std::numbers::sqrt2 / 2,
                           .piston = geometry.piston_right(),
                           .piston_velocity = -std::numbers::sqrt2 / 2}});
      }
    }
  }
  const PairGeometry met = GeometryOf(0.6, 0.05);
  starts.push_back({met,
                    {.position = {0, 0},
                     .direction = {1, 0},
                     .ball_speed = 0.8,
                     .piston = met.tip() + 0.6 * met.tip() / 0.8,
                     .piston_velocity = -0.6}});
  for (const auto& [geometry, start] : starts) {
    ReferenceFlow flow(geometry, start);
    for (int i = 0; i < 1000; ++i) {
      ASSERT_NE(StepAndExchange(flow).kind, EventKind::kEscape);
      ASSERT_TRUE(InsideCell(geometry, flow.state().position, kSlack));
      ASSERT_LE(flow.state().position.x(), flow.state().piston + 1e-15);
    }
  }
}

}  // namespace
}  // namespace ballpiston
