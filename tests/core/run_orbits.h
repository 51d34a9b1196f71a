// Runs all orbits of one block.
#pragma once

#include "tools/flows/numbered_orbits.h"

namespace ballpiston {

template <typename Orbits>
bool RunAll(Engine engine, const PairGeometry& geometry, Orbits& orbits) {
  class AllOrbits : public NumberedOrbits {
   public:
    explicit AllOrbits(Orbits& orbits) : orbits_(orbits) {}
    PairState Start(uint64_t orbit) override { return orbits_.Start(orbit); }
    AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
      return orbits_.Collide(orbit, collision);
    }

   private:
    Orbits& orbits_;
  };
  AllOrbits all(orbits);
  return all.Run(engine, geometry, orbits.count());
}

}  // namespace ballpiston
