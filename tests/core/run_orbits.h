// Runs all orbits of one block.
#pragma once

#include "tools/flows/numbered_orbits.h"

namespace ballpiston {

template <typename Orbits>
bool RunAll(Engine engine, const PairGeometry& geometry, Orbits& orbits) {
  class UntilEscape : public NumberedOrbits {
   public:
    explicit UntilEscape(Orbits& orbits) : orbits_(orbits) {}
    PairState Start(uint64_t orbit) override { return orbits_.Start(orbit); }
    AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
      return collision.escaped ? AfterCollision::kEnd : orbits_.Collide(orbit, collision);
    }

   private:
    Orbits& orbits_;
  };
  UntilEscape until_escape(orbits);
  return RunOrbits(engine, geometry, orbits.count(), until_escape);
}

}  // namespace ballpiston
