#include "core/billiard/orbits.h"

#include "tests/core/billiard/each_target.h"
#include "tests/core/billiard/recorded_collisions.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

void ExpectThreeCollisionsOnTheSurface(const PairGeometry& geometry,
                                       const CollisionsByOrbit& recorded, double rounding) {
  for (const auto& collisions : recorded) {
    ASSERT_EQ(collisions.size(), 3u);
    for (const Collision& collision : collisions) {
      const PairState& state = collision.state;
      ASSERT_FALSE(collision.escaped);
      ASSERT_LE(EnergyError(state), rounding);
      ASSERT_TRUE(InsideCell(geometry, state.position, rounding));
      ASSERT_NEAR(state.position.x(), state.piston, rounding);
      ASSERT_GT(state.ball_speed * state.direction.x(), state.piston_velocity);
    }
  }
}

TEST(Orbits, EveryOrbitMeetsThePistonOnTheCollisionSurface) {
  const PairGeometry geometry = PaperGeometry(0.1);
  for (const Engine engine : kEngines) {
    const double rounding = engine == Engine::kLanesSingle ? 1e-5 : 1e-12;
    for (const uint64_t orbits :
         {1u, 2u, 11u, 12u, 13u, 23u, 24u, 25u, 47u, 48u, 49u, 95u, 96u, 97u, 1000u}) {
      SCOPED_TRACE(testing::Message() << orbits << " by engine " << static_cast<int>(engine));
      ExpectThreeCollisionsOnTheSurface(
          geometry, Recorded(engine, geometry, orbits, {.collisions = 3}), rounding);
    }
  }
}

void ExpectNear(const Collision& first, const Collision& second, double tolerance) {
  EXPECT_EQ(first.ball_wall_hits, second.ball_wall_hits);
  EXPECT_EQ(first.piston_wall_hits, second.piston_wall_hits);
  EXPECT_NEAR(first.time, second.time, tolerance * (1 + first.time));
  EXPECT_NEAR((first.state.position - second.state.position).norm(), 0, tolerance);
  EXPECT_NEAR((first.state.direction - second.state.direction).norm(), 0, tolerance);
  EXPECT_NEAR(first.state.ball_speed, second.state.ball_speed, tolerance);
  EXPECT_NEAR(first.state.piston_velocity, second.state.piston_velocity, tolerance);
}

// Errors grow by a factor of about 2.5 at a wall hit on average, and by more at grazing hits and at
// collisions. So an orbit is compared up to its eighth wall hit.
TEST(Orbits, LanesMeetThePistonWhereTheReferenceDoes) {
  constexpr uint64_t kOrbits = 5000, kMostHits = 8;
  int compared = 0, at_once = 0, later = 0;
  for (const double delta : {0.1, 0.2, 0.32}) {
    const PairGeometry geometry = PaperGeometry(delta);
    const auto reference = Recorded(Engine::kReference, geometry, kOrbits, {.collisions = 3});
    ForEachFusedTarget([&] {
      const auto lanes = Recorded(Engine::kLanes, geometry, kOrbits, {.collisions = 3});
      for (uint64_t orbit = 0; orbit < kOrbits; ++orbit) {
        uint64_t hits = 0;
        for (size_t i = 0; i < 3; ++i) {
          const Collision &first = reference[orbit][i], &second = lanes[orbit][i];
          hits += first.ball_wall_hits;
          if (hits > kMostHits) break;
          ExpectNear(first, second, 1e-8);
          ++compared;
          at_once += first.ball_wall_hits == 0;  // on the way to the first wall
          later += i > 0;
        }
      }
    });
  }
  EXPECT_GT(compared, 1000);
  EXPECT_GT(at_once, 20);
  EXPECT_GT(later, 100);
}

// Stops a run that does not end. A run that can end needs fewer looks.
std::function<bool()> AfterManyLooks() {
  return [looks = 0]() mutable { return ++looks > 500; };
}

TEST(Orbits, PauseEndsARun) {
  for (const Engine engine : kEngines) {
    EXPECT_FALSE(
        RecordedCollisions(PaperGeometry(1e-7), 10, {.pause = [] { return true; }}).RunBy(engine));
  }
}

// In single precision the lanes cannot resolve a cell that nearly vanishes. With a limit an orbit
// that only waits too long has not escaped.
TEST(Orbits, EscapesInLanesAreReported) {
  int looks = 0;
  std::function<bool()> has_escape;
  RecordedCollisions single(GeometryAtShare(kMaxRho - 1e-5, 1), 300,
                            {.collisions = 20, .time_limit = 10, .pause = [&] {
                               return ++looks == 10'000 || has_escape();
                             }});
  has_escape = [&single] {
    return std::ranges::any_of(single.by_orbit(), [](const auto& collisions) {
      return !collisions.empty() && collisions.back().escaped;
    });
  };
  EXPECT_FALSE(single.RunBy(Engine::kLanesSingle));
  EXPECT_TRUE(has_escape());
}

// In all engines and vector widths every orbit is the same as without a limit up to the first
// collision after the limit, and ends there.
TEST(Orbits, TimeLimitChangesNothingWithinIt) {
  constexpr uint64_t kOrbits = 300;
  constexpr size_t kCollisions = 6;
  constexpr double kLimit = 100;  // the mean free time is 97
  const PairGeometry geometry = PaperGeometry(0.1);
  for (const Engine engine : kEngines) {
    const auto free = Recorded(engine, geometry, kOrbits, {.collisions = kCollisions});
    ForEachFusedTarget([&] {
      const auto limited =
          Recorded(engine, geometry, kOrbits, {.collisions = kCollisions, .time_limit = kLimit});
      uint64_t expired = 0;
      for (uint64_t orbit = 0; orbit < kOrbits; ++orbit) {
        const auto &all = free[orbit], &some = limited[orbit];
        size_t i = 0;
        for (; i < kCollisions && all[i].time <= kLimit; ++i) {
          ASSERT_LT(i, some.size());
          EXPECT_FALSE(some[i].expired);
          ExpectSameBits(some[i], all[i]);
        }
        ASSERT_EQ(some.size(), std::min(i + 1, kCollisions));
        if (i == kCollisions) continue;
        EXPECT_TRUE(some[i].expired);
        EXPECT_GT(some[i].time, kLimit);
        ++expired;
      }
      EXPECT_GT(expired, 0u);
      EXPECT_LT(expired, kOrbits);
    });
  }
}

// A ball at rest, and when the piston meets it.
struct AtRest {
  PairState pair;
  double time;
  uint64_t piston_wall_hits;
  double error_in_single;
};

// Balls at the very end of the reach, and the piston on them: in its lane such a ball may be
// rounded out of the reach. And, if the reach is wide, balls within it; the piston moves in either
// direction.
std::vector<AtRest> BallsAtRest(const PairGeometry& geometry) {
  const double left = geometry.piston_left(), stroke = geometry.stroke();
  std::vector<AtRest> balls;
  for (int i = 0; i < 300; ++i) {
    const double angle = 2 * M_PI * i / 300, x = left + (i % 3) * 1e-17;
    const double y = geometry.delta() * geometry.lambda() * std::sin(7 * angle) / 2;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    balls.push_back(
        {{.position = {x, y}, .direction = direction, .piston = x, .piston_velocity = 1},
         2 * stroke,
         1,
         1e-14});
  }
  for (const double share : {0.05, 0.5, 0.95}) {
    if (geometry.delta() < 0.1) continue;
    const double x = left + share * geometry.delta();
    PairState pair = {.position = {x, 0}, .piston = 0.5, .piston_velocity = -1};
    balls.push_back({pair, 0.5 - x, 0, 1e-6});
    pair.piston_velocity = 1;
    balls.push_back({pair, stroke + 0.5 - x, 1, 1e-6});
  }
  return balls;
}

TEST(Orbits, ThePistonMeetsABallAtRestAtItsPlace) {
  for (const double delta : {1e-10, 1e-3, 0.05, 0.2}) {
    const PairGeometry geometry = PaperGeometry(delta);
    const std::vector<AtRest> balls = BallsAtRest(geometry);
    for (const Engine engine : kEngines) {
      const auto recorded =
          Recorded(engine, geometry, balls.size(),
                   {.start = [&](uint64_t i) { return balls[i].pair; }, .pause = AfterManyLooks()});
      for (size_t i = 0; i < balls.size(); ++i) {
        const AtRest& ball = balls[i];
        ASSERT_EQ(recorded[i].size(), 1u);
        const Collision& collision = recorded[i].front();
        ASSERT_FALSE(collision.escaped);
        EXPECT_NEAR(collision.time, ball.time,
                    engine == Engine::kLanesSingle ? ball.error_in_single : 1e-14);
        EXPECT_EQ(collision.ball_wall_hits, 0u);
        EXPECT_EQ(collision.piston_wall_hits, ball.piston_wall_hits);
        EXPECT_EQ(collision.state.ball_speed, 0);
        EXPECT_EQ(collision.state.piston_velocity, -1);
      }
    }
  }
}

// A piston at rest outside of the cell; a ball that flies between two discs for ever; a ball at
// rest out of the piston's reach; and a ball beyond a tip, on its way out.
TEST(Orbits, OrbitsThatCannotEndAreLost) {
  const PairGeometry geometry = PaperGeometry(0.1);
  const std::vector<PairState> pairs = {
      {.position = {0, 0}, .direction = {0.6, 0.8}, .ball_speed = 1, .piston = 0.5},
      {.position = {0, 0},
       .direction = {M_SQRT1_2, M_SQRT1_2},
       .ball_speed = 0.8,
       .piston = 0.5,
       .piston_velocity = 0.6},
      {.position = {0, 0}, .ball_speed = 0, .piston = 0.5, .piston_velocity = 1},
      {.position = {-0.9, 0}, .direction = {-1, 0}, .ball_speed = 1, .piston = 0.5}};
  for (const Engine engine : kEngines) {
    for (const auto& collisions :
         Recorded(engine, geometry, pairs.size(),
                  {.start = [&](uint64_t i) { return pairs[i]; }, .pause = AfterManyLooks()})) {
      ASSERT_EQ(collisions.size(), 1u);
      EXPECT_TRUE(collisions[0].escaped);
      EXPECT_FALSE(collisions[0].expired);
    }
  }
}

// The largest number of starts between two calls of Pause, of orbits that end after few flights or
// none.
class CountedStarts : public OrbitSource {
 public:
  explicit CountedStarts(const PairState& pair) : pair_(pair) {}
  std::optional<OrbitStart> Next() override { return OrbitStart{started_++, pair_}; }
  AfterCollision Collide(uint64_t, const Collision&) override { return AfterCollision::kEnd; }
  bool Pause() override {
    most_ = std::max(most_, started_ - std::exchange(at_look_, started_));
    return started_ > 100'000;
  }
  uint64_t most() const { return most_; }

 private:
  PairState pair_;
  uint64_t started_ = 0, at_look_ = 0, most_ = 0;
};

TEST(Orbits, TheEngineLooksAtPauseAfterFewStarts) {
  const PairGeometry geometry = GeometryAtShare(kPaperRho, 1);
  const double x = geometry.piston_left() + 0.1;
  for (const Engine engine : kEngines) {
    for (const double ball_speed : {0.0, 1.0}) {
      CountedStarts source({.position = {x, 0},
                            .direction = {1, 0},
                            .ball_speed = ball_speed,
                            .piston = x + 1e-3,
                            .piston_velocity = ball_speed - 1});
      EXPECT_FALSE(StartOrbits(engine, geometry, source)->Advance());
      EXPECT_LE(source.most(), 5000u);
    }
  }
}

}  // namespace
}  // namespace ballpiston
