#include "core/model_choice/sampling_cost.h"

#include <cmath>
#include <limits>

#include "core/experiment/energy_relaxation.h"
#include "core/experiment/engine_choice.h"
#include "core/experiment/long_returns.h"
#include "core/experiment/predicted_hits.h"

namespace ballpiston {
namespace {

double SecondsOfHits(Engine engine, const EngineRate& rate, const PredictedHits& hits) {
  return rate.wall_hit * (engine == Engine::kReference ? hits.Events() : hits.ball_wall);
}

// Outgoing directions are drawn by rejection, which takes ever more draws for large exponents.
double StartFactor(const PointParameters& point) {
  constexpr double kByRootOfExponent = 0.3;
  return 1 + kByRootOfExponent * std::sqrt(point.exponent.value_or(0));
}

double SecondsOfAReturn(const EnsembleSpec& spec, const PairGeometry& geometry,
                        const PointParameters& point, const MachineRates& rates) {
  const Engine engine = EngineFor(spec);
  const EngineRate& rate = rates.Of(engine);
  return SecondsOfHits(engine, rate, HitsPerReturn(geometry, *point.epsilon)) +
         rate.sample * StartFactor(point);
}

double SecondsOfACollision(const EnsembleSpec& spec, const PairGeometry& geometry,
                           const MachineRates& rates) {
  if (spec.model == Model::kMarkov) return rates.jump;
  const Engine engine = EngineFor(spec);
  // What is measured of a step of the energy takes most of a jump's time.
  const double measured = spec.experiment == Experiment::kEnergyRelaxation ? rates.jump : 0;
  return SecondsOfHits(engine, rates.Of(engine), HitsPerCollision(geometry)) +
         rates.Of(engine).collision + measured;
}

// Rare long returns carry the mean: their number's scatter is its error.
double ErrorOfReturns(const PairGeometry& geometry, double epsilon) {
  const double long_returns = LongReturnsPerSample(geometry, epsilon);
  if (long_returns == 0) return std::numeric_limits<double>::infinity();
  return std::sqrt(0.9 * (1 + 1 / long_returns));
}

// Of int (ep - 1/6) dt over one orbit from epsilon, in mean free times, over its mean.
double ErrorOfDecay(const PairGeometry& geometry, const PointParameters& point) {
  constexpr double kScatter = 0.42;
  const EnergyRelaxation relaxation(geometry, point);
  const double decay = relaxation.EstimatesOfLimit().back().value;
  return std::fabs(kScatter * 4 * relaxation.unit() / decay);
}

}  // namespace

double SecondsPerSample(const EnsembleSpec& spec, const PairGeometry& geometry,
                        const PointParameters& point, const MachineRates& rates) {
  switch (spec.experiment) {
    case Experiment::kConditionalMeanFreeTime:
    case Experiment::kFirstHit:
      return SecondsOfAReturn(spec, geometry, point, rates);
    case Experiment::kEnergyRelaxation:
      return SecondsOfACollision(spec, geometry, rates) * CollisionsPerOrbit(point);
    default:
      return SecondsOfACollision(spec, geometry, rates);
  }
}

double RelativeErrorOfOneSample(Experiment experiment, const PairGeometry& geometry,
                                const PointParameters& point) {
  switch (experiment) {
    case Experiment::kConditionalMeanFreeTime:
    case Experiment::kFirstHit:
      return ErrorOfReturns(geometry, *point.epsilon);
    case Experiment::kEnergyRelaxation:
      if (!HasRelaxationTime(point.epsilon)) return std::numeric_limits<double>::infinity();
      return point.epsilon ? ErrorOfDecay(geometry, point) : 1.25;
    case Experiment::kMarkovProperty:
      return std::numeric_limits<double>::infinity();
    default:
      return 1.05;
  }
}

}  // namespace ballpiston
