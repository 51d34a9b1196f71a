// Counts of the failures of orbits.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "tools/stability/error_size.h"

namespace ballpiston::stability {

struct Failures {
  uint64_t orbits = 0;
  uint64_t hits = 0;  // of the ball: on walls in the tables of the ball, else on the piston

  uint64_t escapes = 0;         // orbits that left the cell or became NaN
  uint64_t negative_times = 0;  // events before their predecessors
  uint64_t loops = 0;           // orbits that stand still, see tip_sequence.h
  uint64_t inward = 0;          // hits after which the ball still flies into the obstacle
  uint64_t looked_back = 0;     // piston hits that were checked for a missed hit
  uint64_t missed = 0;          // the ball beyond the piston
  uint64_t phantoms = 0;        // contacts with the piston elsewhere
  uint64_t beyond_walls = 0;    // pistons of a gas at a turn or a contact beyond a wall
  double deepest = 0;           // inside a disc, of orbits that did not escape
  double energy = kNoEnergy;    // worst |dE/E|, if it was measured; infinite if NaN

  static constexpr double kNoEnergy = std::numeric_limits<double>::quiet_NaN();

  void SeeEnergy(double error) { energy = std::fmax(energy, ErrorSize(error)); }  // fmax drops NaN

  uint64_t Total() const {
    return escapes + negative_times + loops + inward + missed + phantoms + beyond_walls;
  }

  void Merge(const Failures& other) {
    orbits += other.orbits;
    hits += other.hits;
    escapes += other.escapes;
    negative_times += other.negative_times;
    loops += other.loops;
    inward += other.inward;
    looked_back += other.looked_back;
    missed += other.missed;
    phantoms += other.phantoms;
    beyond_walls += other.beyond_walls;
    deepest = std::max(deepest, other.deepest);
    energy = std::fmax(energy, other.energy);
  }
};

}  // namespace ballpiston::stability
