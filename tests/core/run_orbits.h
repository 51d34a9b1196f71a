// Runs all orbits of one block.
#pragma once

#include "core/billiard/orbits.h"

namespace ballpiston {

template <typename Orbits>
bool RunAll(Engine engine, const PairGeometry& geometry, Orbits& orbits) {
  class Numbered : public NumberedOrbits {
   public:
    explicit Numbered(Orbits& orbits) : orbits_(orbits) {}
    PairState Start(uint64_t orbit) override { return orbits_.Start(orbit); }
    AfterContact Meet(uint64_t orbit, const Contact& contact) override {
      return contact.escaped ? AfterContact::kEnd : orbits_.Meet(orbit, contact);
    }

   private:
    Orbits& orbits_;
  };
  Numbered numbered(orbits);
  return RunOrbits(engine, geometry, orbits.count(), numbered, {});
}

}  // namespace ballpiston
