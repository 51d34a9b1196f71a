#include "core/experiment/expected_limit_error.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/closed_form/mean_free_time.h"
#include "core/experiment/energy_relaxation.h"
#include "core/experiment/pair_experiment.h"

namespace ballpiston {
namespace {

constexpr double kLeastSpeed = 1e-12;  // used for a body at rest, to avoid infinities

double Square(double x) { return x * x; }

// The lengths and times in the bound.
struct Scales {
  explicit Scales(const PairGeometry& pair)
      : geometry(pair), tau(MeanFreeTimesOf(pair).ball_piston), x(pair.stroke() / tau) {}

  double ByTheClock() const { return x * std::log1p(1 / x); }

  PairGeometry geometry;
  double tau;
  double x;  // the length of the piston's interval over the mean free time
};

// Collisions that repeat while the ball is in a narrow tip.
double CuspError(const PairGeometry& geometry) {
  constexpr double kMost = 0.24, kNarrow = 0.19, kShareOfLambda = 0.25;
  const double delta = Square(geometry.delta());
  const double reached = delta / (delta + Square(kShareOfLambda * geometry.lambda()));
  return kMost * std::exp(-Square(geometry.lambda() / kNarrow)) * reached;
}

// The relative error of the autocorrelation's integral.
double EquilibriumError(const Scales& scales) {
  constexpr double kByTheClock = 0.6, kNearTheBound = 2.2;
  const PairGeometry& geometry = scales.geometry;
  const double share = geometry.delta() / PairDeltaBound(geometry.rho());
  const double factor = kByTheClock + kNearTheBound * Square(geometry.lambda() * share);
  return factor * scales.ByTheClock() + CuspError(geometry);
}

// The error of the decay integral, in mean free times.
double DecayError(const Scales& scales, double epsilon) {
  constexpr double kByTheClock = 0.45, kSlowPiston = 0.16, kBall = 0.35, kCusp = 0.1;
  const double u = std::max(std::sqrt(2 * epsilon), kLeastSpeed);
  const double v = std::max(std::sqrt(1 - 2 * epsilon), kLeastSpeed);
  const double piston = scales.ByTheClock() * std::max(1.0, kSlowPiston / u);
  const double ball = 2 * scales.geometry.tip() / (v * scales.tau);
  const double error = kByTheClock * piston + kBall * ball + kCusp * CuspError(scales.geometry) / v;
  return std::min(error, kWindowTimes * std::fabs(epsilon - kMeanPistonEnergy));
}

double LimitOfDecay(const Scales& scales, const PointParameters& point) {
  const EnergyRelaxation relaxation(scales.geometry, point);
  return relaxation.EstimatesOfLimit().back().value / scales.tau;
}

}  // namespace

double ExpectedLimitError(const PointParameters& point) {
  const Scales scales(GeometryOf(point));
  const std::optional<double>& epsilon = point.Find(kEpsilon);
  if (!epsilon) return EquilibriumError(scales);
  return DecayError(scales, *epsilon) / std::fabs(LimitOfDecay(scales, point));
}

double ExpectedLimitErrorOfConduction(const PointParameters& point) {
  constexpr double kOfMorePistons = 1.5;
  return kOfMorePistons * ExpectedLimitError(point);
}

}  // namespace ballpiston
