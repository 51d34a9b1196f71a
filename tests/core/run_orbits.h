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
    AfterContact Meet(uint64_t orbit, const Contact& contact) override {
      return contact.escaped ? AfterContact::kEnd : orbits_.Meet(orbit, contact);
    }

   private:
    Orbits& orbits_;
  };
  UntilEscape until_escape(orbits);
  return RunOrbits(engine, geometry, orbits.count(), until_escape);
}

}  // namespace ballpiston
