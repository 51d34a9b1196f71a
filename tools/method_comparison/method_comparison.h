// Speed against accuracy: measures the error and the work of every method of computing the pair,
// and the gas.
//
// There are five quantities. Each method computes the quantities that it can, with increasing
// numbers of samples until its time is used:
//   kMeanFreeTime  the conditional mean free time of ball and piston at epsilon (eq. numft). A
//                  sample is one return. value = |measured - exact|/exact.
//   kIngoingLaw    the law of the ingoing angle of first hits that start from h^(1), as a histogram
//                  with the cells of `first-hit`. value = its Kullback-Leibler divergence from the
//                  exact law minus the noise floor, which is the mean divergence of samples from
//                  the exact law: (cells - 1)/(2 samples), or its value for few samples per cell
//                  (core/statistics/kl_divergence.h). The difference can be negative.
//   kTrajectory    single orbits of the ball against a twin of 256 bits. A sample is one orbit.
//                  value = mean number of wall hits until they are kParted apart; work/wall_hits is
//                  the cost of one hit.
//   kRelaxationTime
//                  the relaxation time of the piston's energy in equilibrium
//                  (experiment/energy_relaxation.h), at each of several delta: by kLanes, and by
//                  kMarkov and kSpectrum, which are exact only in the limit delta -> 0. A sample is
//                  one orbit. value = |measured - truth|/truth. The truth comes from many more
//                  orbits by kLanes: the curves of the limit tend to the limit's bias.
//   kHeatCurrent   the heat current of one cell between reservoirs at 1.5 and 0.5
//                  (point_runs.h): by FixedSteps, kReference and kLanes, and by kMarkov,
//                  which has the bias of the limit. A sample is a stretch of a trajectory; by
//                  FixedSteps it is a replica. The value and the truth are defined as for
//                  kRelaxationTime.
// statistical_error is one standard error of `value` (before its absolute value is taken). A value
// within kResolved standard errors shows no bias, only an upper bound of the bias.
//   kMeanFreeTime  from the scatter of the sample. If the sample has too few of the long returns
//                  that dominate the mean (expected_returns.h), from a larger sample by kLanes.
//   kIngoingLaw    from the chi-squared law, sqrt((cells - 1)/2)/samples. For a biased law, which
//                  has a larger divergence, sqrt(2 value/samples) is added in quadrature.
//   kTrajectory    from the scatter of the orbits.
//   kRelaxationTime
//                  from the scatter of the measured orbits and of the truth's orbits:
//                  hypot(error, measured/truth * error of the truth)/truth. For the spectrum this
//                  is in effect the error of the truth, which is the same for all methods at one
//                  delta. own_error is the run's own part, error/truth, which falls with more
//                  orbits.
//   kHeatCurrent   the same, from the scatter of the trajectories.
// Orbits that a method loses (fixed steps through a tip) are not among its samples; their hits and
// their work are counted.
// The closed form has no samples and no statistical error. Its value is the bound of its rounding
// error. Its work is the work of one evaluation: of one mean, or of the probabilities of all cells.
// It computes no orbits. The spectrum computes no orbits either. Its work is the work of one
// evaluation, without the computation of its eigenvalues, which takes 0.1 s once for all
// parameters.
//
// All methods start from the same states. The states of rung k are samples of stream k under the
// seed. Therefore the points of a curve are independent, and at each rung only the methods differ.
// The rungs are 16, 64, 256, ... samples (orbits: from 64). The work of the last rung is expected
// within a factor of two of seconds_per_curve. A method is left out if, by a rough prediction, even
// 16 samples take longer. The truth of a relaxation time takes about 8 times seconds_per_curve. A
// delta is left out if the truth would not reach kFewestTruthOrbits in this time. The truth of
// kHeatCurrent takes about as long, and the quantity is left out below kFewestTruthStretches.
// Therefore, for any valid spec, the program takes about 50 times seconds_per_curve, 20 times more
// for the heat current, and 10 times more for each delta of a relaxation time.
//
// For kRelaxationTime and kHeatCurrent each rung and the truth have a seed of their own, and
// therefore different samples.
//
// Work is processor time: other programs do not count, but they affect caches and shared cores.
// Values are functions of the spec; the number of rungs also depends on the work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/flows/paper.h"
#include "tools/method_comparison/method.h"

namespace ballpiston::method_comparison {

inline constexpr double kMinSecondsPerCurve = 0.01;
inline constexpr double kMaxSecondsPerCurve = 60;

inline constexpr size_t kMaxRelaxationDeltas = 8;
inline constexpr uint64_t kFewestTruthOrbits = 256;
inline constexpr uint64_t kFewestTruthStretches = 2048;

// A deviation of more statistical errors than this is a bias: by chance it happens once in 400.
inline constexpr double kResolved = 3;

struct MethodComparisonSpec {
  double rho = kPaperRho;
  double delta = 0.1;
  double epsilon = 0.125;        // the piston's energy, inside (0, 1/2)
  double seconds_per_curve = 1;  // approximate work of each method's largest run
  uint64_t seed = 0;
  std::vector<double> relaxation_deltas = {};  // for kRelaxationTime; if empty, it is left out
};

struct MethodMeasurement {
  Method method = kReference;
  Quantity quantity = Quantity::kMeanFreeTime;
  double delta = 0;      // of the pair, or of the gas; one of relaxation_deltas for kRelaxationTime
  uint64_t samples = 0;  // 0 for the closed form and the spectrum
  uint64_t wall_hits = 0;  // of the ball, in all samples; 0 from kRelaxationTime on (not counted)
  double work = 0;         // seconds
  double value = 0;
  double statistical_error = 0;
  double own_error = 0;                    // without the error of the truth
  std::optional<bool> bias_resolved = {};  // empty for kTrajectory: its value is not a deviation
};

// One sentence for each value that is not permitted. It begins with the program's flag.
std::vector<std::string> Violations(const MethodComparisonSpec& spec);

// The values among 0.2, 0.1, 0.05 and 0.025 that rho permits.
std::vector<double> DefaultRelaxationDeltas(double rho);

// For kHeatCurrent: 0.2, or the gas's bound if that is smaller. rho must be valid.
double GasDelta(double rho);

// Calls `tell` with each measurement as soon as it is made. The order is by quantity, then delta
// (in the order of the list), then method, then time step (descending), then samples (ascending).
// The spec must have no violations.
void CompareMethods(const MethodComparisonSpec& spec,
                    const std::function<void(const MethodMeasurement&)>& tell);

}  // namespace ballpiston::method_comparison
