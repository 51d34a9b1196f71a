#include "core/experiment/return_experiment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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

// At epsilon = 0 there are none, but some returns are long.
constexpr double kLeastShareOfLongReturns = 0.01;

// The ball rests at a distance d from the left end of the piston's way, with a density that falls
// about linearly from d = 0 to delta, so that d has the mean delta/3 and the standard deviation
// delta sqrt(2)/6. The piston comes back after the path 2 (stroke - d).
double ErrorAtRest(const PairGeometry& geometry) {
  const double delta = geometry.delta();
  return delta * std::numbers::sqrt2 / 6 / (geometry.stroke() - delta / 3);
}

}  // namespace

SampleWork WorkOfAReturn(Model, const PointParameters& point) {
  const PredictedHits hits = HitsPerReturn(GeometryOf(point), point[kEpsilon]);
  const double long_returns = LongReturnsPerSample(GeometryOf(point), point[kEpsilon]);
  return {.ball_wall = hits.ball_wall,
          .piston_wall = hits.piston_wall,
          .starts = StartsOf(point),
          .parts = std::clamp(long_returns, kLeastShareOfLongReturns, 1.0)};
}

double ErrorOfAReturn(Model, const PointParameters& point) {
  const PairGeometry geometry = GeometryOf(point);
  if (point[kEpsilon] == 0.5) return ErrorAtRest(geometry);
  const double long_returns = LongReturnsPerSample(geometry, point[kEpsilon]);
  if (long_returns == 0) return std::numeric_limits<double>::infinity();
  return std::sqrt(0.9 * (1 + 1 / long_returns));
}

double EventsOfAReturn(Model, const PointParameters& point) {
  return std::min(LongReturnsPerSample(GeometryOf(point), point[kEpsilon]), 1.0);
}

void CheckToleranceOfReturns(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  const std::vector<double>& energies = spec.grid[kEpsilon];
  if (std::find(energies.begin(), energies.end(), 0.0) == energies.end()) return;
  found.push_back({"target.tolerance",
                   "cannot be reached at epsilon = 0, where the return time has no variance; "
                   "permitted: samples"});
}

}  // namespace ballpiston
