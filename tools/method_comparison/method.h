// The compared methods of computing the ball-piston pair and the gas, and the compared quantities.
#pragma once

#include <cstdint>

#include "core/ensemble/model.h"
#include "core/geometry/pair_geometry.h"
#include "tools/flows/numbered_orbits.h"

namespace ballpiston::method_comparison {

struct Itineraries;
class TwinOrbits;

// A method, which has a curve in the chart.
struct Method {
  const char* name;  // in the output
  // Predicted time of one event, or of one time step, on a processor of about 3 GHz, within a
  // factor of three.
  double seconds_per_event = 0;
  // Runs orbits of pairs, from collision to collision (see billiard/orbits.h). An orbit that is
  // lost, or whose time no longer advances, ends with an escape. Starts and collisions are doubles;
  // between them all numbers have the method's precision. Null: no orbits.
  void (*run_orbits)(const PairGeometry& geometry, uint64_t orbits, NumberedOrbits& source,
                     double time_step) = nullptr;
  // Flies balls from the twins' starts for `hits` wall hits. Null: no orbits.
  Itineraries (*fly)(const PairGeometry& geometry, const TwinOrbits& twins, uint64_t hits,
                     double time_step) = nullptr;
  uint64_t together = 1 << 8;      // the number of orbits that run together
  Model model = Model::kBilliard;  // the service's model for the method, if the service has it
  double time_step = 0;            // in cells per unit speed; 0: no fixed steps

  friend bool operator==(const Method&, const Method&) = default;
};

Method FixedSteps(double time_step);  // naive: a fixed time step, and a repair of each overlap
extern const Method kReferenceSingle;
extern const Method kReference;
extern const Method kReferenceLongDouble;  // 64 bits
extern const Method kReferenceQuadruple;   // 113 bits
extern const Method kLanes;
extern const Method kLanesSingle;
extern const Method kClosedForm;
extern const Method kMarkov;    // the jump process of the limit delta -> 0, sampled
extern const Method kSpectrum;  // the same limit from its generator's eigenvalues, without samples

enum class Quantity { kMeanFreeTime, kIngoingLaw, kTrajectory, kRelaxationTime, kHeatCurrent };

inline const char* Name(Quantity quantity) {
  constexpr const char* kNames[] = {"mean-free-time", "ingoing-law", "trajectory",
                                    "relaxation-time", "heat-current"};
  return kNames[static_cast<int>(quantity)];
}

// At this distance, in cells, an orbit counts as parted from its twin.
inline constexpr double kParted = 1e-3;

}  // namespace ballpiston::method_comparison
