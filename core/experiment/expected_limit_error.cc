#include "core/experiment/expected_limit_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/closed_form/mean_free_time.h"
#include "core/experiment/energy_relaxation.h"
#include "core/experiment/gas_experiment.h"
#include "core/experiment/pair_experiment.h"
#include "core/gas/gas_exchange_rate.h"

namespace ballpiston {
namespace {

constexpr double kLeastSpeed = 1e-12;  // used for a body at rest, to avoid infinities
constexpr double kMostPistonEnergy = 0.5;

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

// The mean of the shorter of the window and an exponential time, in mean free times.
double WithinTheWindow(double mean) { return -mean * std::expm1(-kWindowTimes / mean); }

// The error of the decay integral if a slow ball at speed v keeps its energy for longer.
double SlowBallError(const PairGeometry& geometry, double v) {
  constexpr double kLonger = 0.7, kShort = 2.5;
  constexpr double kTimeToAHit = std::numbers::sqrt2 / 2;  // of a ball at rest, in the limit
  const double stays = geometry.delta() / (std::min(2 * geometry.tip(), geometry.stroke()) * v);
  const double time = kLonger * kTimeToAHit * stays * Square(stays) / (Square(stays) + kShort);
  return (kMostPistonEnergy - kMeanPistonEnergy) * WithinTheWindow(time);
}

// The error of the decay integral, in mean free times.
double DecayError(const Scales& scales, double epsilon) {
  constexpr double kByTheClock = 0.45, kSlowPiston = 0.16, kCusp = 0.1;
  const double u = std::max(std::sqrt(2 * epsilon), kLeastSpeed);
  const double v = std::max(std::sqrt(1 - 2 * epsilon), kLeastSpeed);
  const double piston = scales.ByTheClock() * std::max(1.0, kSlowPiston / u);
  const double error = kByTheClock * piston + SlowBallError(scales.geometry, v) +
                       kCusp * CuspError(scales.geometry) / v;
  return std::min(error, kWindowTimes * std::fabs(epsilon - kMeanPistonEnergy));
}

double LimitOfDecay(const Scales& scales, const PointParameters& point) {
  const EnergyRelaxation relaxation(scales.geometry, point);
  return relaxation.IntegralOfLimit().value / scales.tau;
}

// The delay of an exchange by the slow pistons of the cold wall, over the time that the exchanges
// of a row take. The mean temperature is the unit. Where the delay is short, its factor grows as a
// logarithm.
double DelayAtTheColdWall(const PointParameters& point) {
  const GasGeometry gas = GasGeometryOf(point, GasEnds::kReservoirs);
  const double x = gas.pair().stroke() * InfiniteGasExchangeRate(gas, 1);
  const double slowness = std::sqrt((1 + point[kHot] / point[kCold]) / 2) - 1;
  const auto columns = static_cast<double>(gas.shape().columns);
  const double delay = x * slowness * 2 / (1 + columns);
  if (delay == 0) return 0;
  return delay * std::fmax(1.3, 0.8 + std::log1p(0.3 / delay));
}

}  // namespace

double ExpectedLimitError(const PointParameters& point) {
  const Scales scales(GeometryOf(point));
  const std::optional<double>& epsilon = point.Find(kEpsilon);
  if (!epsilon) return EquilibriumError(scales);
  return DecayError(scales, *epsilon) / std::fabs(LimitOfDecay(scales, point));
}

double ExpectedLimitErrorInAGas(const PointParameters& point) {
  constexpr double kOfMorePistons = 1.7;
  return kOfMorePistons * ExpectedLimitError(point);
}

double ExpectedLimitErrorOfConduction(const PointParameters& point) {
  const double of_gas = ExpectedLimitErrorInAGas(point);
  return of_gas + (1 - of_gas) / (1 + 1 / DelayAtTheColdWall(point));
}

}  // namespace ballpiston
