#include "core/experiment/expected_returns.h"

#include "core/billiard/orbits.h"
#include "core/experiment/returns.h"
#include "tests/core/billiard/recorded_collisions.h"
#include "tests/core/preamble.h"
#include "tests/core/run_orbits.h"

namespace ballpiston {
namespace {

struct CountedReturn : ReturnOrbit {
  Collision collision;
  AfterCollision Collide(const ReturnStarts&, const Collision& end) {
    collision = end;
    return AfterCollision::kEnd;
  }
};

// Starts are from the invariant law, exponent 1. The predictions are exact means: 5 standard
// errors, 6e-7 false alarms each.
TEST(PredictedHits, MatchReturnsAtAnEnergy) {
  const PairGeometry geometry = PaperGeometry(0.25);
  for (const double epsilon : {0.05, 0.2, 0.35, 0.45}) {
    const PredictedHits predicted = HitsPerReturn(geometry, epsilon);
    EXPECT_EQ(predicted.Events(), 1 + predicted.ball_wall + predicted.piston_wall);
    for (const Engine engine : kEngines) {
      const ReturnStarts starts = {geometry, epsilon, 1, {.seed = 1, .stream = 2}};
      const BlockResult empty;
      BlockOrbits<CountedReturn, ReturnStarts> returns(starts, {.samples = 20'000}, empty);
      ASSERT_TRUE(RunAll(engine, geometry, returns));
      Moments ball_wall, piston_wall;
      for (uint64_t i = 0; i < returns.count(); ++i) {
        ball_wall.Add(static_cast<double>(returns[i].collision.ball_wall_hits));
        piston_wall.Add(static_cast<double>(returns[i].collision.piston_wall_hits));
      }
      EXPECT_NEAR(ball_wall.mean, predicted.ball_wall, 5 * *ball_wall.StandardError());
      EXPECT_NEAR(piston_wall.mean, predicted.piston_wall, 5 * *piston_wall.StandardError());
    }
  }
}

}  // namespace
}  // namespace ballpiston
