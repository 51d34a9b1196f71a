#include "core/billiard/longest_wait.h"

#include "core/experiment/returns.h"
#include "tests/core/billiard/recorded_collisions.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// The test expects that no return takes more than a share of 0.05 of the longest wait. If return
// times have an exponential law, the longest of n = 500 takes about log n = 6 time scales, which is
// a share of 0.006. A return of a share of 0.05 then has the probability e^-50.
void ExpectShort(const PairGeometry& geometry, double epsilon) {
  const ReturnStarts starts = {geometry, epsilon, 1, {.seed = 5, .stream = 6}};
  const LongestWait longest(geometry);
  const auto start = [&](uint64_t orbit) { return starts.Draw(orbit); };
  const auto returns = Recorded(Engine::kLanes, geometry, 500, {.start = start});
  for (uint64_t orbit = 0; orbit < returns.size(); ++orbit) {
    const Collision& collision = returns[orbit].at(0);
    EXPECT_FALSE(collision.escaped);
    EXPECT_LT(collision.time, 0.05 * longest.From(start(orbit)))
        << geometry.rho() << " " << epsilon;
  }
}

TEST(LongestWait, EveryOrbitOfTheBilliardIsShorter) {
  for (const double rho : {0.5 + 1e-6, 0.6, 0.7}) {
    for (const double share : {1.0, 0.1}) {
      for (const double epsilon : {0.0, 1e-6, 0.01, 0.25, 0.49, 0.5 - 1e-6, 0.5}) {
        ExpectShort(GeometryAtShare(rho, share), epsilon);
      }
    }
  }
  // Here the discs are nearly flat. Only balls that are slow, or alone, cost few hits.
  for (const double share : {1.0, 0.3}) {
    for (const double epsilon : {0.0, 0.5 - 1e-11}) {
      ExpectShort(GeometryAtShare(kMaxRho - 1e-5, share), epsilon);
    }
  }
}

TEST(LongestWait, APistonAtRestThatCannotBeReachedIsNotWaitedFor) {
  const PairGeometry geometry = PaperGeometry(0.1);
  const LongestWait longest(geometry);
  const PairState apart = {.ball_speed = 1, .piston = geometry.tip()};
  EXPECT_EQ(longest.From(apart), 0);
  PairState state = apart;
  for (const double velocity : {1e-300, 1e-9, 0.5}) {
    state.piston_velocity = velocity;
    EXPECT_GT(longest.From(state), 1 / velocity);
  }
}

// A slow piston is a wall while the ball finds it, and no wall if it moves further.
TEST(LongestWait, ASlowPistonIsWaitedForAsIfAtRest) {
  const PairGeometry geometry = PaperGeometry(0.1);
  const LongestWait longest(geometry);
  PairState state = {.ball_speed = 1, .piston = geometry.tip() - 0.05};
  const double at_rest = longest.From(state);
  EXPECT_GT(at_rest, 1e4);
  EXPECT_LT(at_rest, 1e6);
  state.piston_velocity = 1e-12;
  EXPECT_EQ(longest.From(state), at_rest);
  state.piston_velocity = 1e-4;
  EXPECT_GT(longest.From(state), at_rest);
}

}  // namespace
}  // namespace ballpiston
