// The ways to compute the ball-piston pair that are compared, and what about.
#ifndef BALLPISTON_CORE_METHOD_COMPARISON_METHOD_H_
#define BALLPISTON_CORE_METHOD_COMPARISON_METHOD_H_

namespace ballpiston {

enum class Method {
  kFixedStep,  // naive: moves by a fixed time step, repairs what penetrated
  kReferenceSingle,
  kReference,
  kReferenceLongDouble,  // 64 bits
  kReferenceQuadruple,   // 113 bits
  kLanes,
  kLanesSingle,
  kClosedForm,
  kMarkov,    // the jump process of the limit delta -> 0, sampled
  kSpectrum,  // the same limit by its generator's eigenvalues, without samples
};

enum class Quantity { kMeanFreeTime, kIngoingLaw, kTrajectory, kRelaxationTime };

// From here on an orbit and its twin are told apart, in cells.
inline constexpr double kParted = 1e-3;

// One curve of the chart: a method, and for kFixedStep its time step in cells per unit speed.
struct MethodVariant {
  Method method;
  double time_step = 0;  // 0 for the others
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_METHOD_COMPARISON_METHOD_H_
