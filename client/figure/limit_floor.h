// From which tolerance on the limit of rare collisions may no longer stand for the billiard, and
// where it costs less: what the measurements of RELAXATION_TIME at one delta say.
//
// The limit's methods, jump process and spectrum, share a bias that no work removes: their floor.
// It is read off the spectrum, which has no scatter of its own. Below kFloorResolved statistical
// errors (which are the truth's) it may be chance: then only a bound of it is known, `value` plus
// kFloorResolved errors.
//
// The billiard has no bias, and its error falls as 1/sqrt(work): the crossing is the work at which
// it is the floor. For a larger tolerance, which less work meets, the limit answers as well and
// costs less; for a smaller one it may not be used. With a bound the crossing lies there or further
// right.
#ifndef BALLPISTON_CLIENT_FIGURE_LIMIT_FLOOR_H_
#define BALLPISTON_CLIENT_FIGURE_LIMIT_FLOOR_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "client/figure/method_measurement.h"

namespace ballpiston::client {

inline constexpr double kFloorResolved = 2;

// Slow pistons carry much of the scatter, and few orbits have any: the error of fewer orbits is
// mostly chance itself.
inline constexpr uint64_t kFewestOrbits = 256;

struct LimitFloor {
  double delta = 0;
  double bias = 0;                           // relative, as measured
  double error = 0;                          // its standard error
  double work = 0;                           // seconds: one evaluation of the spectrum
  std::optional<double> crossing_work = {};  // empty if no run of the billiard is long enough

  bool IsResolved() const { return bias >= kFloorResolved * error; }
  double Height() const { return IsResolved() ? bias : bias + kFloorResolved * error; }
};

// By descending delta, each once; without those that have no spectrum.
std::vector<LimitFloor> FloorsOf(const std::vector<MethodMeasurement>& measurements);

// A run's statistical error without the truth's.
double OwnError(const MethodMeasurement& run, const LimitFloor& floor);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_FIGURE_LIMIT_FLOOR_H_
