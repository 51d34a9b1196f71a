// Speed against accuracy: what every method of computing the pair gives for how much work.
//
// Each method answers three questions, with ever more samples until its time is spent:
//   kMeanFreeTime  the conditional mean free time of ball and piston at epsilon (eq. numft). A
//                  sample is one return. value = |measured - exact|/exact.
//   kIngoingLaw    the law of the ingoing angle of first hits begun from h^(1), histogrammed as
//                  `first-hit` does. value = its Kullback-Leibler divergence from the exact law
//                  minus what samples from that law would have: the noise floor
//                  (cells - 1)/(2 samples), or what it is for few samples a cell
//                  (ingoing_divergence.h). Can be negative.
//   kTrajectory    single orbits of the ball against a twin of 256 bits. A sample is one orbit.
//                  value = mean number of wall hits until they are kParted apart; work/wall_hits is
//                  the cost of one hit.
// statistical_error is one standard error of `value` (before its absolute value is taken): a value
// within some three of it shows no bias, only that the bias is not larger.
//   kMeanFreeTime  from the scatter of the sample. Where this has too few of the long returns that
//                  carry the mean (long_returns.h), from that of a larger one, by kLanes.
//   kIngoingLaw    that of chi-squared, sqrt((cells - 1)/2)/samples; of a biased law, where the
//                  divergence is larger, sqrt(2 value/samples) besides.
//   kTrajectory    from the scatter of the orbits.
// Orbits that a method loses (fixed steps through a tip) are not among its samples; their hits and
// their work are counted.
// The closed form has no samples and no statistical error; its value is the bound of its rounding
// errors, its work that of one evaluation: of one mean, of the probabilities of all cells. It knows
// no orbits.
//
// All methods start from the same states: those of rung k are samples of stream k under the seed,
// so that a curve's points are independent and methods differ by what they do alone. The rungs are
// 16, 64, 256, ... samples (orbits: from 64); the last one is that whose work is expected within a
// factor of two of seconds_per_curve. A method that by a rough prediction takes longer than that
// even for 16 is left out. So for any valid spec the whole takes some 50 times seconds_per_curve.
//
// Work is processor time of the calling thread, so what other programs do does not count (but
// caches and shared cores do). Values are functions of the spec; which rungs there are depends on
// the work as well.
#ifndef BALLPISTON_CORE_METHOD_COMPARISON_METHOD_COMPARISON_H_
#define BALLPISTON_CORE_METHOD_COMPARISON_METHOD_COMPARISON_H_

#include <cstdint>
#include <functional>
#include <stop_token>

#include "absl/status/status.h"
#include "core/method_comparison/method.h"

namespace ballpiston {

inline constexpr double kMinSecondsPerCurve = 0.01;
inline constexpr double kMaxSecondsPerCurve = 60;

struct MethodComparisonSpec {
  double rho = 0;
  double delta = 0;
  double epsilon = 0;            // the piston's energy, inside (0, 1/2)
  double seconds_per_curve = 1;  // work of each method's largest run, about
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

// Tells each measurement as it is made; kinds are grouped by quantity, then method, then time step
// (descending), then ascending samples. INVALID_ARGUMENT as PairGeometry::Create says, or with an
// epsilon outside (0, 1/2) or seconds_per_curve outside [0.01, 60]; CANCELLED if `stop` came before
// the end, which is looked at some ten times a second at least.
absl::Status CompareMethods(const MethodComparisonSpec& spec, const std::stop_token& stop,
                            const std::function<void(const MethodMeasurement&)>& tell);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_METHOD_COMPARISON_METHOD_COMPARISON_H_
