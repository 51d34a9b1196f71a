#include <memory>

#include "core/ensemble/block_result.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/energy_relaxation.h"
#include "core/experiment/expected_returns.h"
#include "server/processor_time.h"
#include "tools/method_comparison/point_runs.h"

namespace ballpiston::method_comparison {
namespace {

EnsembleSpec SpecOf(const PairGeometry& geometry, uint64_t seed, Method method) {
  return {.experiment = &kEnergyRelaxation,
          .grid = {{kRho, {geometry.rho()}}, {kDelta, {geometry.delta()}}},
          .seed = seed,
          .model = method == Method::kMarkov ? Model::kMarkov : Model::kBilliard};
}

PointParameters PointOf(const PairGeometry& geometry) {
  return {{kRho, geometry.rho()}, {kDelta, geometry.delta()}};
}

}  // namespace

double EnergyRelaxationRuns::PredictedSecondsPerOrbit() const {
  constexpr double kPerEvent = 2e-9, kPerCollision = 4e-7;
  return CollisionsPerOrbit(PointOf(geometry)) *
         (kPerCollision + kPerEvent * HitsPerCollision(geometry).Events());
}

PointEstimate EnergyRelaxationRuns::Run(Method method, const SampleRange& samples) const {
  const auto experiment = PointExperiment::Create(SpecOf(geometry, seed, method), 0);
  const double begin = server::ThreadSeconds();
  const BlockResult merged =
      RunBlock(*experiment, {.first = samples.first, .samples = samples.count});
  const Estimate estimate = experiment->FirstEstimate(merged);
  return {.value = estimate.value,
          .error = estimate.standard_error.value_or(0),
          .samples = merged.samples,
          .seconds = server::ThreadSeconds() - begin};
}

PointEstimate EnergyRelaxationRuns::BySpectrum() const {
  RelaxationSpectrum::Get();
  Estimate time;
  const double seconds = server::SecondsOf(
      [&] { time = EnergyRelaxation(geometry, PointOf(geometry)).EstimatesOfLimit().front(); });
  return {.value = time.value, .error = time.standard_error.value_or(0), .seconds = seconds};
}

}  // namespace ballpiston::method_comparison
