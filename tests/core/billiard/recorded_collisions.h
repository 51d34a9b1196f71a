// Orbits of a few collisions from equilibrium, and all collisions that they reported.
#pragma once

#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"
#include "tools/flows/numbered_orbits.h"

namespace ballpiston {

inline constexpr Engine kEngines[] = {Engine::kReference, Engine::kLanes, Engine::kLanesSingle};

class RecordedCollisions : public NumberedOrbits {
 public:
  RecordedCollisions(const PairGeometry& geometry, uint64_t orbits, size_t collisions)
      : geometry_(geometry), collisions_(collisions), by_orbit_(orbits) {}

  PairState Start(uint64_t orbit) override {
    CounterRandom random(7, 8, orbit);
    return DrawFromCollisionMeasure(geometry_, random);
  }

  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    by_orbit_[orbit].push_back(collision);
    return by_orbit_[orbit].size() < collisions_ ? AfterCollision::kGoOn : AfterCollision::kEnd;
  }

  const std::vector<std::vector<Collision>>& by_orbit() const { return by_orbit_; }

 private:
  PairGeometry geometry_;
  size_t collisions_;
  std::vector<std::vector<Collision>> by_orbit_;
};

inline RecordedCollisions Recorded(Engine engine, const PairGeometry& geometry, uint64_t orbits,
                                   size_t collisions) {
  RecordedCollisions recorded(geometry, orbits, collisions);
  EXPECT_TRUE(recorded.Run(engine, geometry, orbits));
  return recorded;
}

inline void ExpectSameBits(const Collision& first, const Collision& second) {
  EXPECT_EQ(first.escaped, second.escaped);
  if (first.escaped) return;
  EXPECT_EQ(first.time, second.time);
  EXPECT_EQ(first.state.position, second.state.position);
  EXPECT_EQ(first.state.direction, second.state.direction);
  EXPECT_EQ(first.state.ball_speed, second.state.ball_speed);
  EXPECT_EQ(first.state.piston, second.state.piston);
  EXPECT_EQ(first.state.piston_velocity, second.state.piston_velocity);
  EXPECT_EQ(first.ball_wall_hits, second.ball_wall_hits);
  EXPECT_EQ(first.piston_wall_hits, second.piston_wall_hits);
}

}  // namespace ballpiston
