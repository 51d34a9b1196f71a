// The paper's figure numft: conditional collision rates, measured at several penetrations delta,
// scaled by the mean free time, collapse on one curve,
//
//   tau_bp / tau_conditional(epsilon) = phi(epsilon)        (eq. numft),
//
// and, inset, the measured 1/tau_bp against delta beside the closed form (eq. taubpmft).
//
// These functions list the jobs and closed forms that the figure needs, and make tables and a
// gnuplot script from their answers. command/figure.cc asks the server.
#ifndef BALLPISTON_CLIENT_FIGURE_MEAN_FREE_TIME_FIGURE_H_
#define BALLPISTON_CLIENT_FIGURE_MEAN_FREE_TIME_FIGURE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ballpiston/v1/analytic.pb.h"
#include "ballpiston/v1/result.pb.h"
#include "ballpiston/v1/spec.pb.h"

namespace ballpiston::client {

inline constexpr char kMeanFreeTimeFigure[] = "mean-free-time";

struct MeanFreeTimeQuestion {
  double rho = 0.529561127988977;  // the paper's, (sqrt(33) - 2)/(5 sqrt(2))
  std::vector<double> delta = {0.2, 0.1, 0.05};
  int64_t samples = 10'000;  // at each energy and delta, as in the paper
  uint64_t seed = 0;
};

// The paper's 59 energies: 1/100, ..., 49/100, and 1/200, 1/400, ..., 1/3200 from either end;
// ascending.
std::vector<double> PaperEnergies();

v1::EnsembleSpec ConditionalSpec(const MeanFreeTimeQuestion& question);
v1::EnsembleSpec EquilibriumSpec(const MeanFreeTimeQuestion& question);
// tau_bp at the deltas measured, and phi on a fine grid of energies.
v1::EvaluatePairsRequest ScaleRequest(const MeanFreeTimeQuestion& question);
// The inset's curve: from half the smallest delta to twice the largest, or to `delta_bound`.
v1::EvaluatePairsRequest CurveRequest(const MeanFreeTimeQuestion& question, double delta_bound);

struct MeanFreeTimeAnswers {
  std::vector<v1::PointResult> conditional;
  std::vector<v1::PointResult> equilibrium;
  v1::EvaluatePairsResponse scale;
  v1::EvaluatePairsResponse curve;
};

// The figure as files' contents.
struct MeanFreeTimeFiles {
  std::string measured_csv;
  std::string inset_csv;
  std::string exact_csv;
  std::string script;
};

// INTERNAL if an answer lacks what the figure shows.
absl::StatusOr<MeanFreeTimeFiles> MakeFiles(const MeanFreeTimeQuestion& question,
                                            const MeanFreeTimeAnswers& answers);

// The largest |z| among the estimates that have one; 0 if none has.
struct LargestZ {
  double value = 0;
  int estimates = 0;
};
LargestZ LargestDeviation(const MeanFreeTimeAnswers& answers);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_FIGURE_MEAN_FREE_TIME_FIGURE_H_
