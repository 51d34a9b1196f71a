// Tangent vectors of the lanes against those of the reference. The exponents are compared with
// another program, and those of gases with differences of nearby orbits.
#include <type_traits>

#include "core/billiard/tangent_plane.h"
#include "core/gas/pair_tangents.h"
#include "tests/core/billiard/recorded_collisions.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

constexpr size_t kCollisions = 4;

// The collisions of orbits, and the growth of the first two vectors in each wait.
template <typename Tangents>
class RecordedGrowths : public RecordedCollisions {
 public:
  RecordedGrowths(Engine engine, const PairGeometry& geometry, size_t orbits)
      : RecordedCollisions(geometry, orbits, {.collisions = kCollisions}),
        geometry_(geometry),
        tangents_(orbits),
        growths_(orbits) {
    EXPECT_TRUE(RunBy(engine));
  }
  const std::vector<std::array<double, 2>>& growths(size_t orbit) const { return growths_[orbit]; }
  uint64_t HitsOf(size_t orbit) const {
    uint64_t hits = 0;
    for (const Collision& collision : by_orbit()[orbit]) hits += collision.ball_wall_hits;
    return hits;
  }

 private:
  PairState Start(uint64_t orbit) override {
    const PairState state = RecordedCollisions::Start(orbit);
    tangents_[orbit].emplace(geometry_, state);
    return state;
  }
  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    tangents_[orbit]->Collide(collision);
    const auto growth = tangents_[orbit]->TakeGrowth();
    growths_[orbit].push_back({growth[0], growth[1]});
    return RecordedCollisions::Collide(orbit, collision);
  }
  bool FollowsTangents() const override { return true; }
  void FollowEvent(uint64_t orbit, const Event& event, const PairState& after) override {
    if constexpr (std::is_same_v<Tangents, PairTangents>) tangents_[orbit]->Follow(event, after);
  }

  PairGeometry geometry_;
  std::vector<std::optional<Tangents>> tangents_;
  std::vector<std::vector<std::array<double, 2>>> growths_;  // by orbit
};

// Orbits of both engines agree for about 30 wall hits. Some of them have four collisions until
// then. The third wait is the first one to which the signs of wall hits matter.
TEST(TangentPlane, TheReflectionOfAnExchangeIsThatOfSixComponents) {
  constexpr uint64_t kMostHits = 16;
  const PairGeometry geometry = GeometryOf(0.53, 0.3);
  const RecordedGrowths<PairTangents> reference(Engine::kReference, geometry, 5000);
  const RecordedGrowths<TangentPlane> lanes(Engine::kLanes, geometry, 5000);
  size_t compared = 0;
  for (size_t i = 0; i < 5000; ++i) {
    if (reference.HitsOf(i) > kMostHits) continue;
    ++compared;
    EXPECT_EQ(lanes.HitsOf(i), reference.HitsOf(i));
    for (size_t k = 0; k < kCollisions; ++k) {
      for (const size_t vector : {0, 1}) {
        EXPECT_NEAR(lanes.growths(i)[k][vector], reference.growths(i)[k][vector], 1e-5);
      }
    }
  }
  EXPECT_GT(compared, 50u);
}

// The growth of the two vectors over two equal waits with this map.
std::array<double, 2> GrowthWithExponent(double exponent) {
  const Collision collision = {
      .state = {.direction = {0.6, 0.8}, .ball_speed = 0.8, .piston_velocity = -0.6},
      .time = 50,
      .ball_wall_hits = 7,
      .piston_wall_hits = 2,
      .flights = {.aa = 0.9, .at = 0.2, .ta = 1.7, .tt = 0.4, .exponent = exponent}};
  TangentPlane plane;
  for (int wait = 0; wait < 2; ++wait) plane.Collide(collision);
  return plane.TakeGrowth();
}

// The second vector does not notice how much longer the first one is.
TEST(TangentPlane, LongWaitsNeedNoRangeOfExponents) {
  const auto long_wait = GrowthWithExponent(60), longest = GrowthWithExponent(1e6);
  EXPECT_NEAR(longest[0] - long_wait[0], 2 * (1e6 - 60) * std::numbers::ln2, 1e-9);
  EXPECT_NEAR(longest[1], long_wait[1], 1e-12);
}

}  // namespace
}  // namespace ballpiston
