// Speed against accuracy: what every method of computing the pair gives for how much work.
//
// Each method answers those of four questions that it can, with ever more samples until its time
// is spent:
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
//   kRelaxationTime
//                  the relaxation time of the piston's energy in equilibrium
//                  (experiment/energy_relaxation.h), at each of several delta: by kLanes, and by
//                  kMarkov and kSpectrum, which are exact in the limit delta -> 0 alone. A sample
//                  is one orbit. value = |measured - truth|/truth, the truth being that of many
//                  more orbits by kLanes: so what the curves of the limit tend to is its bias.
// statistical_error is one standard error of `value` (before its absolute value is taken): a value
// within some three of it shows no bias, only that the bias is not larger.
//   kMeanFreeTime  from the scatter of the sample. Where this has too few of the long returns that
//                  carry the mean (long_returns.h), from that of a larger one, by kLanes.
//   kIngoingLaw    that of chi-squared, sqrt((cells - 1)/2)/samples; of a biased law, where the
//                  divergence is larger, sqrt(2 value/samples) besides.
//   kTrajectory    from the scatter of the orbits.
//   kRelaxationTime
//                  from the scatter of the measured orbits and of the truth's together: relatively,
//                  hypot(error, measured/truth * error of the truth)/truth. For the spectrum it is
//                  the truth's in effect, the same for all that is measured at one delta.
// Orbits that a method loses (fixed steps through a tip) are not among its samples; their hits and
// their work are counted.
// The closed form has no samples and no statistical error; its value is the bound of its rounding
// errors, its work that of one evaluation: of one mean, of the probabilities of all cells. It knows
// no orbits. Neither has the spectrum: its work is that of one evaluation, once its eigenvalues are
// there, which takes 0.1 s and serves all parameters.
//
// All methods start from the same states: those of rung k are samples of stream k under the seed,
// so that a curve's points are independent and methods differ by what they do alone. The rungs are
// 16, 64, 256, ... samples (orbits: from 64); the last one is that whose work is expected within a
// factor of two of seconds_per_curve. A method that by a rough prediction takes longer than that
// even for 16 is left out. The truth about a relaxation time takes some 8 times seconds_per_curve;
// a delta at which it would not have kFewestTruthOrbits by then is left out likewise. So for any
// valid spec the whole takes some 50 times seconds_per_curve, and 10 more for each such delta.
//
// The orbits of kRelaxationTime are samples of the point's own stream (point_stream.h) under the
// seed: each rung has its own, and so has the truth.
//
// Work is processor time of the calling thread, so what other programs do does not count (but
// caches and shared cores do). Values are functions of the spec; which rungs there are depends on
// the work as well.
#ifndef BALLPISTON_CORE_METHOD_COMPARISON_METHOD_COMPARISON_H_
#define BALLPISTON_CORE_METHOD_COMPARISON_METHOD_COMPARISON_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <vector>

#include "absl/status/status.h"
#include "core/method_comparison/method.h"

namespace ballpiston {

inline constexpr double kMinSecondsPerCurve = 0.01;
inline constexpr double kMaxSecondsPerCurve = 60;

inline constexpr size_t kMaxRelaxationDeltas = 8;
inline constexpr uint64_t kFewestTruthOrbits = 256;

struct MethodComparisonSpec {
  double rho = 0;
  double delta = 0;
  double epsilon = 0;            // the piston's energy, inside (0, 1/2)
  double seconds_per_curve = 1;  // work of each method's largest run, about
  uint64_t seed = 0;
  std::vector<double> relaxation_deltas = {};  // of kRelaxationTime; none: it is left out
};

struct MethodMeasurement {
  Method method = Method::kReference;
  double time_step = 0;  // of kFixedStep, in cells per unit speed; 0 for the others
  Quantity quantity = Quantity::kMeanFreeTime;
  double delta = 0;        // of the pair; one of relaxation_deltas for kRelaxationTime
  uint64_t samples = 0;    // 0 for the closed form and the spectrum
  uint64_t wall_hits = 0;  // the ball's, in all samples; 0 for kRelaxationTime: not counted
  double work = 0;         // seconds
  double value = 0;
  double statistical_error = 0;
};

// Tells each measurement as it is made; kinds are grouped by quantity, then delta (as they were
// listed), then method, then time step (descending), then ascending samples. INVALID_ARGUMENT as
// PairGeometry::Create says, of any delta, or with an epsilon outside (0, 1/2), seconds_per_curve
// outside [0.01, 60] or more than kMaxRelaxationDeltas; CANCELLED if `stop` came before
// the end, which is looked at some ten times a second at least.
absl::Status CompareMethods(const MethodComparisonSpec& spec, const std::stop_token& stop,
                            const std::function<void(const MethodMeasurement&)>& tell);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_METHOD_COMPARISON_METHOD_COMPARISON_H_
