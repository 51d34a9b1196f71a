// Speed against accuracy: a work-precision diagram of every method of computing the pair.
//
//   a  relative error of the conditional mean free time against work
//   b  bias of the ingoing law of first hits, as a Kullback-Leibler divergence, against work
//   c  wall hits until an orbit leaves its twin in high precision, against the time a hit takes
//   d  relative error of the energy's relaxation time at several delta against work, by the
//   billiard
//      and by the limit delta -> 0: where the limit will do (limit_floor.h)
//
// In a and b a method's points are its measured errors, and a line is what chance alone explains:
// one statistical error. Points within kResolved of them are pale: they show no bias. A dashed line
// is the bias of a method whose longest run resolves one. In b the law's noise floor is subtracted,
// so chance may make a value negative: its size is drawn. What lies below the panel, 0 or the
// closed form's rounding errors, is drawn at its lower edge. In d a line is the method's own
// statistical error, without the truth's; a point is pale by both errors together. Without
// relaxation times (at a rho that permits none of the program's delta) d is left out.
//
// These functions make a table and a gnuplot script from measurements.
// command/figure_speed_accuracy.cc runs the program that measures.
#ifndef BALLPISTON_CLIENT_FIGURE_SPEED_ACCURACY_FIGURE_H_
#define BALLPISTON_CLIENT_FIGURE_SPEED_ACCURACY_FIGURE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/figure/method_measurement.h"

namespace ballpiston::client {

inline constexpr char kSpeedAccuracyFigure[] = "speed-accuracy";

// Statistical errors from which on a deviation is a bias: chance alone gives more once in 400.
inline constexpr double kResolved = 3;

// Errors estimated from fewer samples are mostly chance themselves: in the table, not drawn.
inline constexpr uint64_t kFewestDrawn = 64;

struct SpeedAccuracyQuestion {
  double rho = 0.529561127988977;  // the paper's, (sqrt(33) - 2)/(5 sqrt(2))
  double delta = 0.1;
  double epsilon = 0.125;
  double seconds_per_curve = 1;  // of each method's largest run, about
  uint64_t seed = 0;
  std::vector<double> relaxation_deltas = {};  // of panel d; none: the program's
};

// The flags for the program that measures the figure.
std::vector<std::string> ComparisonFlags(const SpeedAccuracyQuestion& question);

// Whether its value is a bias. False for TRAJECTORY, whose value is no deviation.
bool IsBiasResolved(const MethodMeasurement& measurement);

// The figure as files' contents.
struct SpeedAccuracyFiles {
  std::string csv;
  std::string script;
};

// FAILED_PRECONDITION if a panel would be empty.
absl::StatusOr<SpeedAccuracyFiles> MakeFiles(const SpeedAccuracyQuestion& question,
                                             const std::vector<MethodMeasurement>& measurements);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_FIGURE_SPEED_ACCURACY_FIGURE_H_
