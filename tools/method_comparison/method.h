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

enum class Quantity {
  kMeanFreeTime,
  kIngoingLaw,
  kTrajectory,
  kRelaxationTime,
  kHeatCurrent,
  kLimitFloor
};

// The names in the output.
inline const char* Name(Method method) {
  constexpr const char* kNames[] = {"fixed-step",
                                    "billiard-reference-single",
                                    "billiard-reference",
                                    "billiard-reference-long-double",
                                    "billiard-reference-quadruple",
                                    "billiard",
                                    "billiard-single",
                                    "closed-form",
                                    "markov",
                                    "spectrum"};
  return kNames[static_cast<int>(method)];
}
inline const char* Name(Quantity quantity) {
  constexpr const char* kNames[] = {"mean-free-time",  "ingoing-law",  "trajectory",
                                    "relaxation-time", "heat-current", "limit-floor"};
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
