// Speed against accuracy: what every method of computing the pair gives for how much work.
//
// Each method answers three questions, with ever more samples until its time is spent:
//   kMeanFreeTime  the conditional mean free time of ball and piston at epsilon (eq. numft). A
//                  sample is one return. value = |measured - exact| / exact.
//   kIngoingLaw    the law of the ingoing angle of first hits begun from h^(1), histogrammed as
//                  `first-hit` does. value = its Kullback-Leibler divergence from the exact law
//                  minus the noise floor (cells - 1)/(2 samples): its bias, once it exceeds
//                  statistical_error.
//   kTrajectory    single orbits of the ball against a twin in much higher precision. A sample is
//                  one orbit. value = mean number of wall hits until they are kParted apart;
//                  work / hits is the cost of one hit.
// Bias and statistical error are told apart by statistical_error: a value within some three of it
// shows no bias, only that the bias is not larger.
//
// Work is processor time of the calling thread, so what other programs do does not count (but
// caches and shared cores do). Everything else is a function of the spec.
#ifndef BALLPISTON_CORE_METHOD_COMPARISON_METHOD_COMPARISON_H_
#define BALLPISTON_CORE_METHOD_COMPARISON_METHOD_COMPARISON_H_

#include <cstdint>
#include <functional>
#include <stop_token>

#include "absl/status/status.h"

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
};

enum class Quantity { kMeanFreeTime, kIngoingLaw, kTrajectory };

inline constexpr double kParted = 1e-3;  // in cells

struct MethodComparisonSpec {
  double rho = 0;
  double delta = 0;
  double epsilon = 0;              // the piston's energy, inside (0, 1/2)
  double seconds_per_curve = 1;    // work of each method's largest run, about
  uint64_t seed = 0;
};

struct MethodMeasurement {
  Method method = Method::kReference;
  double time_step = 0;  // of kFixedStep, in cells per unit speed; 0 for the others
  Quantity quantity = Quantity::kMeanFreeTime;
  uint64_t samples = 0;    // 0 for the closed form
  uint64_t wall_hits = 0;  // the ball's, in all samples
  double work = 0;         // seconds
  double value = 0;
  double statistical_error = 0;
};

// Tells each measurement as it is made; kinds are grouped by quantity, then method, then time step,
// then ascending samples. INVALID_ARGUMENT as PairGeometry::Create says, or with an epsilon outside
// (0, 1/2) or seconds_per_curve outside [0.01, 60]; CANCELLED if `stop` came before the end.
absl::Status CompareMethods(const MethodComparisonSpec& spec, const std::stop_token& stop,
                            const std::function<void(const MethodMeasurement&)>& tell);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_METHOD_COMPARISON_METHOD_COMPARISON_H_
