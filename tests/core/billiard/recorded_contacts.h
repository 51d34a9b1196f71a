// Orbits of a few collisions from equilibrium, and all contacts that they reported.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/sampling/invariant_measure.h"
#include "tools/flows/numbered_orbits.h"

namespace ballpiston {

inline constexpr Engine kEngines[] = {Engine::kReference, Engine::kLanes, Engine::kLanesSingle};

class RecordedContacts : public NumberedOrbits {
 public:
  RecordedContacts(const PairGeometry& geometry, uint64_t orbits, size_t collisions)
      : geometry_(geometry), collisions_(collisions), by_orbit_(orbits) {}

  PairState Start(uint64_t orbit) override {
    CounterRandom random(7, 8, orbit);
    return DrawFromCollisionMeasure(geometry_, random);
  }

  AfterContact Meet(uint64_t orbit, const Contact& contact) override {
    by_orbit_[orbit].push_back(contact);
    return by_orbit_[orbit].size() < collisions_ ? AfterContact::kGoOn : AfterContact::kEnd;
  }

  const std::vector<std::vector<Contact>>& by_orbit() const { return by_orbit_; }

 private:
  PairGeometry geometry_;
  size_t collisions_;
  std::vector<std::vector<Contact>> by_orbit_;
};

inline RecordedContacts Recorded(Engine engine, const PairGeometry& geometry, uint64_t orbits,
                                 size_t collisions) {
  RecordedContacts contacts(geometry, orbits, collisions);
  EXPECT_TRUE(RunOrbits(engine, geometry, orbits, contacts));
  return contacts;
}

}  // namespace ballpiston
