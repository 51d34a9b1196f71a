#include "core/experiment/expected_returns.h"

#include "core/billiard/orbits.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/returns.h"
#include "tests/core/billiard/recorded_collisions.h"
#include "tests/core/preamble.h"
#include "tests/core/run_orbits.h"

namespace ballpiston {
namespace {

struct Counted {
  Moments time, ball_wall, piston_wall;
  void Add(const Collision& collision) {
    time.Add(collision.time);
    ball_wall.Add(static_cast<double>(collision.ball_wall_hits));
    piston_wall.Add(static_cast<double>(collision.piston_wall_hits));
  }
};

struct CountedReturn : ReturnOrbit {
  Collision collision;
  AfterCollision Collide(const ReturnStarts&, const Collision& end) {
    collision = end;
    return AfterCollision::kEnd;
  }
};

// The predictions are exact means: 5 standard errors, 6e-7 false alarms each. An orbit starts in
// collision, and its hits before the second collision are counted.
void ExpectCounted(const PredictedHits& predicted, const Counted& counted) {
  EXPECT_NEAR(counted.ball_wall.mean, predicted.ball_wall, 5 * *counted.ball_wall.StandardError());
  EXPECT_NEAR(counted.piston_wall.mean, predicted.piston_wall,
              5 * *counted.piston_wall.StandardError());
  EXPECT_EQ(predicted.Events(), 1 + predicted.ball_wall + predicted.piston_wall);
}

TEST(PredictedHits, MatchOrbitsInEquilibrium) {
  for (const double rho : {0.501, kPaperRho, 0.65}) {
    const PairGeometry geometry = GeometryAtShare(rho, 0.6);
    for (const Engine engine : kEngines) {
      Counted counted;
      const RecordedCollisions recorded = Recorded(engine, geometry, 20'000, 1);
      for (const auto& collisions : recorded.by_orbit()) counted.Add(collisions.front());
      ExpectCounted(HitsPerCollision(geometry), counted);
      EXPECT_NEAR(counted.time.mean, MeanFreeTimesOf(geometry).ball_piston,
                  5 * *counted.time.StandardError());
    }
  }
}

// Starts are from the invariant law, exponent 1.
TEST(PredictedHits, MatchReturnsAtAnEnergy) {
  const PairGeometry geometry = PaperGeometry(0.25);
  for (const double epsilon : {0.05, 0.2, 0.35, 0.45}) {
    for (const Engine engine : kEngines) {
      const ReturnStarts starts = {geometry, epsilon, 1, {.seed = 1, .stream = 2}};
      const BlockResult empty;
      BlockOrbits<CountedReturn, ReturnStarts> returns(starts, {.samples = 20'000}, empty);
      ASSERT_TRUE(RunAll(engine, geometry, returns));
      Counted counted;
      for (uint64_t i = 0; i < returns.count(); ++i) counted.Add(returns[i].collision);
      ExpectCounted(HitsPerReturn(geometry, epsilon), counted);
    }
  }
}

}  // namespace
}  // namespace ballpiston
