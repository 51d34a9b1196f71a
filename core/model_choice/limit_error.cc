#include "core/model_choice/limit_error.h"

#include <algorithm>
#include <cmath>

#include "core/closed_form/mean_free_time.h"
#include "core/experiment/point_experiment.h"
#include "core/geometry/pair_geometry.h"
#include "core/model_choice/sampling_cost.h"

namespace ballpiston {
namespace {

// Of the bound on delta: there a collision takes some 250 wall hits, and a pilot some 2 s.
constexpr double kPilotsShareOfTheBound = 0.3;
// From an energy whose slow partner takes as long as the window, the error does not fall with
// delta.
constexpr double kWhereItScales = 0.3;

EnsembleSpec SpecOfPilot(const PilotPlace& place) {
  EnsembleSpec spec = {.experiment = Experiment::kEnergyRelaxation,
                       .grid = {.rho = {place.rho}, .delta = {place.delta}},
                       .target = {.samples = kPilotOrbits},
                       .model = Model::kBilliard};
  if (place.epsilon) spec.grid.epsilon = {*place.epsilon};
  return spec;
}

PairGeometry GeometryOf(double rho, double delta) {
  return PairGeometry::Create(rho, delta).value();
}

// How long the slow partner takes for its way, in mean free times.
double SlowTime(double way, double speed, double mean_free_time) {
  return way / (std::max(speed, 1e-12) * mean_free_time);
}

}  // namespace

double ExpectedLimitError(const PointParameters& point) {
  constexpr double kEquilibrium = 0.4, kPiston = 0.5, kBall = 1, kMost = 10;
  const PairGeometry geometry = GeometryOf(point.rho, point.delta);
  const double tau = MeanFreeTimesOf(geometry).ball_piston;
  const double stroke = geometry.lambda() + 2 * geometry.delta();
  const double x = stroke / tau;
  const double in_equilibrium = kEquilibrium * x * std::log1p(1 / x);
  if (!point.epsilon) return in_equilibrium;
  const double piston = SlowTime(stroke, std::sqrt(2 * *point.epsilon), tau);
  const double ball = SlowTime(2 * geometry.tip(), std::sqrt(1 - 2 * *point.epsilon), tau);
  return std::min(in_equilibrium + kPiston * piston + kBall * ball, kMost);
}

PointParameters PointOf(const PilotPlace& place) {
  return {.rho = place.rho, .delta = place.delta, .epsilon = place.epsilon};
}

PilotPlace PilotPlaceFor(const PointParameters& point) {
  PilotPlace place = {point.rho, point.delta, point.epsilon};
  PointParameters cheap = point;
  cheap.delta = std::max(point.delta, kPilotsShareOfTheBound * PairDeltaBound(point.rho));
  if (ExpectedLimitError(cheap) < kWhereItScales) place.delta = cheap.delta;
  return place;
}

std::optional<Pilot> RunPilot(const PilotPlace& place, std::stop_token stop) {
  const auto experiment = PointExperiment::Create(SpecOfPilot(place), 0);
  BlockResult merged;
  for (uint64_t block = 0; !experiment->TargetReached(block, merged); ++block) {
    const std::optional<BlockResult> result = experiment->RunBlock(block, stop);
    if (!result) return std::nullopt;
    merged.Merge(*result);
  }
  const Estimate time = experiment->FirstEstimate(merged);
  return Pilot{.difference = time.value / *time.limit - 1,
               .standard_error = *time.standard_error / std::fabs(*time.limit)};
}

double SecondsOfPilot(const PilotPlace& place, const MachineRates& rates) {
  const PointParameters point = PointOf(place);
  return static_cast<double>(kPilotOrbits) *
         SecondsPerSample(SpecOfPilot(place), GeometryOf(place.rho, place.delta), point, rates);
}

Pilot PredictedPilot(const PilotPlace& place) {
  const PointParameters point = PointOf(place);
  const double error = RelativeErrorOfOneSample(Experiment::kEnergyRelaxation,
                                                GeometryOf(place.rho, place.delta), point);
  return {.difference = ExpectedLimitError(point),
          .standard_error = error / std::sqrt(static_cast<double>(kPilotOrbits)),
          .predicted = true};
}

double LimitErrorBound(const Pilot& pilot, const PilotPlace& place, const PointParameters& point) {
  const double there = std::fabs(pilot.difference) + 2 * pilot.standard_error;
  return std::max(there * point.delta / place.delta, ExpectedLimitError(point));
}

}  // namespace ballpiston
