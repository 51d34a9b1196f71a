#include "tools/method_comparison/point_runs.h"

#include <memory>

#include "core/ensemble/block_result.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/energy_relaxation.h"
#include "core/experiment/expected_returns.h"
#include "core/experiment/gas_experiment.h"
#include "core/experiment/steady_gas.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_shape.h"
#include "core/statistics/batch_means.h"
#include "server/processor_time.h"
#include "tools/flows/fixed_step_gas.h"

namespace ballpiston::method_comparison {
namespace {

// The first estimate of the service's answer, and the processor time of the samples.
PointEstimate Answered(EnsembleSpec spec, uint64_t samples, bool is_truth) {
  spec.target.samples = static_cast<int64_t>(samples);
  spec.seed += 2 * samples + (is_truth ? 1 : 0);
  const auto experiment = PointExperiment::Create(spec, 0);
  const double begin = server::ThreadSeconds();
  const BlockResult merged = FoldPoint(*experiment);
  const double seconds = server::ThreadSeconds() - begin;
  const PointSummary summary = experiment->Summarize(merged);
  if (summary.estimates.empty()) return {.seconds = seconds};
  const Estimate& estimate = summary.estimates.front();
  return {.value = estimate.value,
          .error = estimate.standard_error.value_or(0),
          .samples = summary.samples,
          .seconds = seconds};
}

// ---- relaxation times ----

double SecondsPerOrbit(const PairGeometry& geometry, const PointParameters& point) {
  constexpr double kPerEvent = 2e-9, kPerCollision = 4e-7;
  return CollisionsPerOrbit(point) *
         (kPerCollision + kPerEvent * HitsPerCollision(geometry).Events());
}

PointEstimate BySpectrum(const PairGeometry& geometry, const PointParameters& point) {
  BoundedValue time;
  const double seconds =
      server::SecondsOf([&] { time = EnergyRelaxation(geometry, point).IntegralOfLimit(); });
  return {.value = time.value, .error = time.error, .seconds = seconds};
}

// ---- heat currents ----

// A ball between two pistons. At the same work the error grows as the number of cells. With more
// cells the error would hide the bias of the limit.
constexpr GasShape kComparedChain = {.columns = 1};
constexpr double kComparedHot = 1.5;
constexpr double kComparedCold = 0.5;

const SteadyGas& AsGas(const PointExperiment& experiment) {
  return static_cast<const SteadyGas&>(experiment);
}

// The times at which a replica by fixed time steps has relaxed, and at which it ends. A stretch of
// a gas of one cell takes half of the relaxation time.
double TimeToRelax(const SteadyGas& gas) { return 8 * gas.stretch(); }
double TimeToTheEnd(const SteadyGas& gas) { return 32 * gas.stretch(); }

// Stops earlier if a ball is lost.
void AdvanceTo(double time, FixedStepGas& gas, GasMeter& meter) {
  while (meter.escapes() == 0 && gas.NextTime() <= time) meter.See(gas.Step());
}

void MeasureReplica(const SteadyGas& gas, double time_step, uint64_t sample, BatchMeans& means) {
  const GasRandom random = gas.RandomOf(sample);
  CounterRandom of_start = random.OfStart();
  const GasState start = DrawGas(gas.geometry(), gas.TemperaturesAtStart(), of_start);
  GasMeter meter(gas.geometry(), start);
  FixedStepGas steps(gas.geometry(), start, gas.WallsOf(random), time_step);
  AdvanceTo(TimeToRelax(gas), steps, meter);
  meter.Begin(TimeToRelax(gas));
  AdvanceTo(TimeToTheEnd(gas), steps, meter);
  meter.End(TimeToTheEnd(gas));
  if (meter.escapes() > 0) return;
  // The mean temperature is 1, so the current is not scaled.
  static_assert(kComparedHot + kComparedCold == 2);
  means.Add(meter.carried(), 2 * static_cast<double>(gas.geometry().balls()) * meter.duration());
}

PointEstimate ByFixedSteps(const SteadyGas& gas, double time_step, uint64_t replicas) {
  const double begin = server::ThreadSeconds();
  BatchMeans means;
  for (uint64_t i = 0; i < replicas; ++i) MeasureReplica(gas, time_step, i, means);
  return {.value = means.Ratio().value_or(0),
          .error = means.StandardError().value_or(0),
          .samples = means.batches(),
          .seconds = server::ThreadSeconds() - begin};
}

double SecondsPerSample(const Method& method, const SteadyGas& gas) {
  constexpr double kPerStep = 4e-8, kPerHit = 1e-9, kPerEvent = 5e-8, kPerExchange = 4e-7,
                   kPerJump = 4e-8;
  if (method.time_step > 0) return kPerStep * TimeToTheEnd(gas) / method.time_step;
  const SampleWork work = WorkOfReplica(method.model, gas.geometry(), gas.stretch());
  if (method.model == Model::kBilliardReference) return kPerEvent * work.Events();
  return kPerHit * work.ball_wall + kPerExchange * work.collisions + kPerJump * work.jumps;
}

EnsembleSpec WithModelOf(const Method& method, EnsembleSpec spec) {
  spec.model = method.model;
  return spec;
}

PairGeometry GeometryOf(const EnsembleSpec& spec) {
  return *PairGeometry::Create(spec.grid[kRho].front(), spec.grid[kDelta].front());
}

}  // namespace

double PointRuns::PredictedSecondsPerSample(const Method& method) const {
  if (spec.experiment == &kEnergyRelaxation) {
    return SecondsPerOrbit(GeometryOf(spec), PointAt(spec, 0));
  }
  return SecondsPerSample(method, AsGas(*PointExperiment::Create(WithModelOf(method, spec), 0)));
}

PointEstimate PointRuns::Run(const Method& method, uint64_t samples) const {
  if (method == kSpectrum) return BySpectrum(GeometryOf(spec), PointAt(spec, 0));
  EnsembleSpec run = WithModelOf(method, spec);
  if (method.time_step == 0) return Answered(run, samples, false);
  run.seed += samples;
  return ByFixedSteps(AsGas(*PointExperiment::Create(run, 0)), method.time_step, samples);
}

PointEstimate PointRuns::Truth(uint64_t samples) const {
  return Answered(WithModelOf(kLanes, spec), samples, true);
}

PointRuns RelaxationRuns(const PairGeometry& geometry, uint64_t seed) {
  return {{.experiment = &kEnergyRelaxation,
           .grid = {{kRho, {geometry.rho()}}, {kDelta, {geometry.delta()}}},
           .seed = seed}};
}

PointRuns HeatCurrentRuns(double rho, double delta, uint64_t seed) {
  return {{.experiment = &kGasConduction,
           .grid = {{kRho, {rho}},
                    {kDelta, {delta}},
                    {kCells, {CodeOf(kComparedChain)}},
                    {kHot, {kComparedHot}},
                    {kCold, {kComparedCold}}},
           .seed = seed}};
}

}  // namespace ballpiston::method_comparison
