// The compared methods of computing the ball-piston pair and the gas, and the compared quantities.
#pragma once

namespace ballpiston::method_comparison {

enum class Method {
  kFixedStep,  // naive: a fixed time step, and a repair of each overlap
  kReferenceSingle,
  kReference,
  kReferenceLongDouble,  // 64 bits
  kReferenceQuadruple,   // 113 bits
  kLanes,
  kLanesSingle,
  kClosedForm,
  kMarkov,    // the jump process of the limit delta -> 0, sampled
  kSpectrum,  // the same limit from the eigenvalues of its generator, without samples
};

enum class Quantity { kMeanFreeTime, kIngoingLaw, kTrajectory, kRelaxationTime, kHeatCurrent };

struct MethodProperties {
  const char* name;  // in the output
  // Predicted time of one event, or of one time step, on a processor of about 3 GHz, within a
  // factor of three; 0 for a method that computes no orbits of the pair.
  double seconds_per_event;
};

inline const MethodProperties& PropertiesOf(Method method) {
  static constexpr MethodProperties kProperties[] = {{"fixed-step", 3e-9},
                                                     {"billiard-reference-single", 4e-8},
                                                     {"billiard-reference", 4e-8},
                                                     {"billiard-reference-long-double", 1e-7},
                                                     {"billiard-reference-quadruple", 3e-6},
                                                     {"billiard", 4e-9},
                                                     {"billiard-single", 4e-9},
                                                     {"closed-form", 0},
                                                     {"markov", 0},
                                                     {"spectrum", 0}};
  return kProperties[static_cast<int>(method)];
}
inline const char* Name(Method method) { return PropertiesOf(method).name; }
inline const char* Name(Quantity quantity) {
  constexpr const char* kNames[] = {"mean-free-time", "ingoing-law", "trajectory",
                                    "relaxation-time", "heat-current"};
  return kNames[static_cast<int>(quantity)];
}

// At this distance, in cells, an orbit counts as parted from its twin.
inline constexpr double kParted = 1e-3;

// One curve of the chart: a method, and for kFixedStep its time step in cells per unit speed.
struct MethodVariant {
  Method method;
  double time_step = 0;  // 0 for the other methods
};

}  // namespace ballpiston::method_comparison
