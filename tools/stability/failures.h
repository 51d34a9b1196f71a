// Counts of the failures of orbits.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/statistics/moments.h"

namespace ballpiston::stability {

// The size of an error of the energy. An error that is not a number becomes infinite. Otherwise it
// would pass every limit: std::max drops NaN, and a comparison with NaN is false.
inline double ErrorSize(double error) {
  return std::isnan(error) ? std::numeric_limits<double>::infinity() : std::fabs(error);
}

struct Failures {
  uint64_t orbits = 0;
  uint64_t hits = 0;  // of the ball: on walls in the tables of the ball, else on the piston

  uint64_t escapes = 0;         // orbits that left the cell or became NaN
  uint64_t negative_times = 0;  // events before their predecessors
  uint64_t loops = 0;           // orbits that stand still, see ball_watch.h
  uint64_t inward = 0;          // hits after which the ball still flies into the obstacle
  uint64_t looked_back = 0;     // piston hits that were checked for a missed hit
  uint64_t missed = 0;          // the ball beyond the piston
  uint64_t phantoms = 0;        // contacts with the piston elsewhere
  uint64_t beyond_walls = 0;    // pistons of a gas at a turn or a contact beyond a wall
  // The worst |dE/E|; NaN if it was not measured, infinite if an error was not a number.
  double energy = std::numeric_limits<double>::quiet_NaN();
  // For each orbit that reached its end, the change of dE/E in its second half; for a gas, the
  // change since its start. The rounding of the start does not contribute.
  Moments gain = {};

  void SeeEnergy(double error) { energy = std::fmax(energy, ErrorSize(error)); }  // fmax drops NaN
  uint64_t Total() const;  // failures of all kinds
  void Merge(const Failures& other);
};

// A kind of failure. README.md says when it is counted.
struct FailureKind {
  uint64_t Failures::*count;
  const char* letter;
  const char* name;  // the plural, in tables
};

inline constexpr FailureKind kFailureKinds[] = {{&Failures::escapes, "e", "escapes"},
                                                {&Failures::negative_times, "n", "negative times"},
                                                {&Failures::loops, "l", "loops"},
                                                {&Failures::inward, "i", "still inward"},
                                                {&Failures::missed, "m", "missed"},
                                                {&Failures::phantoms, "p", "phantoms"},
                                                {&Failures::beyond_walls, "b", "pistons beyond"}};

inline uint64_t Failures::Total() const {
  uint64_t total = 0;
  for (const FailureKind& kind : kFailureKinds) total += this->*kind.count;
  return total;
}

inline void Failures::Merge(const Failures& other) {
  for (const FailureKind& kind : kFailureKinds) this->*kind.count += other.*kind.count;
  orbits += other.orbits;
  hits += other.hits;
  looked_back += other.looked_back;
  energy = std::fmax(energy, other.energy);
  gain.Merge(other.gain);
}

}  // namespace ballpiston::stability
