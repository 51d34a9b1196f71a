// Orbits, and all collisions that they reported.
#pragma once

#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"
#include "tools/flows/numbered_orbits.h"

namespace ballpiston {

inline constexpr Engine kEngines[] = {Engine::kReference, Engine::kLanes, Engine::kLanesSingle};

inline PairState StartInEquilibrium(const PairGeometry& geometry, uint64_t orbit) {
  CounterRandom random(7, 8, orbit);
  return DrawFromCollisionMeasure(geometry, random);
}

struct OrbitOptions {
  size_t collisions = 1;                                // of an orbit
  std::function<PairState(uint64_t orbit)> start = {};  // without it in equilibrium
  double time_limit = HUGE_VAL;
  OrbitDevice* device = nullptr;
  std::function<bool()> pause = [] { return false; };
};

using CollisionsByOrbit = std::vector<std::vector<Collision>>;

class RecordedCollisions : public NumberedOrbits {
 public:
  RecordedCollisions(const PairGeometry& geometry, uint64_t orbits, OrbitOptions options)
      : geometry_(geometry), options_(std::move(options)), by_orbit_(orbits) {}

  bool RunBy(Engine engine) { return Run(engine, geometry_, by_orbit_.size()); }
  const CollisionsByOrbit& by_orbit() const { return by_orbit_; }

  PairState Start(uint64_t orbit) override {
    return options_.start ? options_.start(orbit) : StartInEquilibrium(geometry_, orbit);
  }
  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    by_orbit_[orbit].push_back(collision);
    const bool is_last = by_orbit_[orbit].size() >= options_.collisions;
    return is_last ? AfterCollision::kEnd : AfterCollision::kGoOn;
  }
  double TimeLimit() const override { return options_.time_limit; }
  OrbitDevice* Device() const override { return options_.device; }
  bool Pause() override { return options_.pause(); }

 private:
  PairGeometry geometry_;
  OrbitOptions options_;
  CollisionsByOrbit by_orbit_;
};

inline CollisionsByOrbit Recorded(Engine engine, const PairGeometry& geometry, uint64_t orbits,
                                  OrbitOptions options) {
  RecordedCollisions recorded(geometry, orbits, std::move(options));
  EXPECT_TRUE(recorded.RunBy(engine));
  return recorded.by_orbit();
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
