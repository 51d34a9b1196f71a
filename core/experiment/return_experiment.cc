#include "core/experiment/return_experiment.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/experiment/long_returns.h"
#include "core/experiment/pair_experiment.h"
#include "core/experiment/predicted_hits.h"

namespace ballpiston {
namespace {

// Outgoing directions are drawn by rejection, which takes more draws for larger exponents.
double StartsOf(const PointParameters& point) {
  constexpr double kByRootOfExponent = 0.3;
  return 1 + kByRootOfExponent * std::sqrt(point.Find(kExponent).value_or(0));
}

}  // namespace

SampleWork WorkOfAReturn(Model, const PointParameters& point) {
  const PredictedHits hits = HitsPerReturn(GeometryOf(point), point[kEpsilon]);
  return {.ball_wall = hits.ball_wall, .piston_wall = hits.piston_wall, .starts = StartsOf(point)};
}

double ErrorOfAReturn(Model, const PointParameters& point) {
  const double long_returns = LongReturnsPerSample(GeometryOf(point), point[kEpsilon]);
  if (long_returns == 0) return std::numeric_limits<double>::infinity();
  return std::sqrt(0.9 * (1 + 1 / long_returns));
}

void CheckToleranceOfReturns(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  const std::vector<double>& energies = spec.grid[kEpsilon];
  if (std::find(energies.begin(), energies.end(), 0.0) == energies.end()) return;
  found.push_back({"target.tolerance",
                   "cannot be reached at epsilon = 0, where the return time has no variance; "
                   "permitted: samples"});
}

}  // namespace ballpiston
