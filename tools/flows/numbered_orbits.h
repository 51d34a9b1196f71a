// Orbits of an engine that have numbers from 0, with one call for each start and for each
// collision.
#pragma once

#include <cstdint>
#include <limits>
#include <stop_token>

#include "core/billiard/orbits.h"

namespace ballpiston {

class NumberedOrbits {
 public:
  virtual ~NumberedOrbits() = default;
  virtual PairState Start(uint64_t orbit) = 0;
  virtual AfterCollision Collide(uint64_t orbit, const Collision& collision) = 0;
  virtual OrbitDevice* Device() const { return nullptr; }
  virtual double TimeLimit() const { return std::numeric_limits<double>::infinity(); }
};

// Runs orbits 0 ... count - 1 to their ends. Returns false if `stop` was requested before.
bool RunOrbits(Engine engine, const PairGeometry& geometry, uint64_t count, NumberedOrbits& orbits,
               const std::stop_token& stop = {});

}  // namespace ballpiston
