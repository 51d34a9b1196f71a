#include "core/method_comparison/energy_relaxation_runs.h"

#include <bit>
#include <memory>

#include "core/experiment/energy_relaxation.h"
#include "core/experiment/point_experiment.h"
#include "core/experiment/predicted_hits.h"
#include "core/method_comparison/processor_time.h"

namespace ballpiston {
namespace {

// The plan cuts blocks of at most kMinBlocks-th of all samples: of so many that a run may be one.
EnsembleSpec SpecOf(const PairGeometry& geometry, uint64_t seed, Method method, uint64_t orbits) {
  return {.experiment = Experiment::kEnergyRelaxation,
          .grid = {.rho = {geometry.rho()}, .delta = {geometry.delta()}},
          .target = {.samples = static_cast<int64_t>(kMinBlocks * orbits)},
          .seed = seed,
          .model = method == Method::kMarkov ? Model::kMarkov : Model::kBilliard};
}

PointParameters PointOf(const PairGeometry& geometry) {
  return {.rho = geometry.rho(), .delta = geometry.delta()};
}

std::optional<BlockResult> RunBlocks(const PointExperiment& experiment, const SampleRange& samples,
                                     const std::stop_token& stop) {
  BlockResult merged;
  const uint64_t size = experiment.plan().block_size;
  for (uint64_t done = 0; done < samples.count; done += size) {
    const std::optional<BlockResult> block =
        experiment.RunBlock((samples.first + done) / size, stop);
    if (!block || stop.stop_requested()) return std::nullopt;
    merged.Merge(*block);
  }
  return merged;
}

}  // namespace

SampleRange TruthOf(uint64_t orbits) {
  // Runs are [4^k, 2 4^k): from 2 4^k on there is room for as many.
  const bool is_start_of_run = std::countr_zero(orbits) % 2 == 0;
  return {is_start_of_run ? 2 * orbits : orbits, orbits};
}

double EnergyRelaxationRuns::PredictedSecondsPerOrbit() const {
  constexpr double kPerEvent = 2e-9, kPerCollision = 4e-7;
  return CollisionsPerOrbit(PointOf(geometry_)) *
         (kPerCollision + kPerEvent * HitsPerCollision(geometry_).Events());
}

std::optional<RelaxationTime> EnergyRelaxationRuns::Run(Method method, const SampleRange& samples,
                                                        const std::stop_token& stop) const {
  const auto experiment =
      PointExperiment::Create(SpecOf(geometry_, seed_, method, samples.count), 0);
  const double begin = ThreadSeconds();
  const std::optional<BlockResult> merged = RunBlocks(*experiment, samples, stop);
  if (!merged) return std::nullopt;
  const double seconds = ThreadSeconds() - begin;
  const Estimate estimate = experiment->FirstEstimate(*merged);
  return RelaxationTime{.value = estimate.value,
                        .error = estimate.standard_error.value_or(0),
                        .samples = merged->samples,
                        .seconds = seconds};
}

RelaxationTime EnergyRelaxationRuns::BySpectrum() const {
  RelaxationSpectrum::Get();
  Estimate time;
  const double seconds = SecondsOf(
      [&] { time = EnergyRelaxation(geometry_, PointOf(geometry_)).EstimatesOfLimit().front(); });
  return {.value = time.value, .error = time.standard_error.value_or(0), .seconds = seconds};
}

}  // namespace ballpiston
