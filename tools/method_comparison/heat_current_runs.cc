#include "tools/method_comparison/heat_current_runs.h"

#include <memory>

#include "core/experiment/all_experiments.h"
#include "core/experiment/gas_experiment.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_meter.h"
#include "server/processor_time.h"
#include "tools/flows/fixed_step_gas.h"

namespace ballpiston::method_comparison {
namespace {

Model ModelOf(Method method) {
  switch (method) {
    case Method::kMarkov:
      return Model::kMarkov;
    case Method::kReference:
      return Model::kBilliardReference;
    default:
      return Model::kBilliard;
  }
}

// The experiment gas-conduction. The fixed steps are measured in the same way as the billiard.
std::unique_ptr<const PointExperiment> ExperimentOf(double rho, double delta, uint64_t seed,
                                                    Method method) {
  const EnsembleSpec spec = {.experiment = &kGasConduction,
                             .grid = {{kRho, {rho}},
                                      {kDelta, {delta}},
                                      {kCells, {CodeOf(kComparedChain)}},
                                      {kHot, {kComparedHot}},
                                      {kCold, {kComparedCold}}},
                             .seed = seed,
                             .model = ModelOf(method)};
  return PointExperiment::Create(spec, 0);
}

const GasExperiment& AsGas(const PointExperiment& experiment) {
  return static_cast<const GasExperiment&>(experiment);
}

// The gas gives its energies only at the end of the step, after all events. In a chain this does no
// harm: the two pistons of a ball are on opposite sides, and the ball exchanges with at most one of
// them in a step. The current is measured from the ball's energy, which is then its energy after
// the exchange. A piston may have several events in a step; its energies between them last no time.
// In a lattice a ball may exchange with two pistons in a step, and the transported energy would be
// wrong.
void Tell(const FixedStepGas& gas, const GasEvent& event, GasMeter& meter) {
  if (event.kind == EventKind::kBallPiston) {
    meter.Exchange({event.time, event.ball, event.piston, event.direction,
                    EnergyOf(gas.BallNow(event.ball)), EnergyOf(gas.PistonNow(event.piston))});
  } else if (event.kind == EventKind::kPistonWall) {
    meter.SetPiston(event.time, event.piston, EnergyOf(gas.PistonNow(event.piston)));
  } else if (event.kind == EventKind::kEscape) {
    meter.CountEscape();
  }
}

// Stops earlier if a ball is lost.
void AdvanceTo(double time, FixedStepGas& gas, GasMeter& meter) {
  while (gas.time() < time && meter.escapes() == 0) {
    for (const GasEvent& event : gas.Advance()) Tell(gas, event, meter);
  }
}

void MeasureByFixedSteps(const GasExperiment& experiment, double time_step, uint64_t sample,
                         BlockResult& result) {
  const GasRandom random = experiment.RandomOf(sample);
  CounterRandom of_start = random.OfStart();
  const GasState start = DrawGas(experiment.geometry(), experiment.TemperaturesAtStart(), of_start);
  GasMeter meter(experiment.geometry(), start);
  FixedStepGas gas(experiment.geometry(), start, experiment.WallsOf(random), time_step);
  AdvanceTo(experiment.times().relax, gas, meter);
  meter.Begin(gas.time());
  AdvanceTo(experiment.times().Total(), gas, meter);
  meter.End(gas.time());
  if (meter.escapes() > 0) return;
  ++result.samples;
  for (size_t part = 0; part < experiment.MeasuredParts(); ++part) {
    experiment.MeasurePart(part, meter, result);
  }
}

PointEstimate RunFixedSteps(const GasExperiment& experiment, double time_step,
                            const SampleRange& samples) {
  const double begin = server::ThreadSeconds();
  BlockResult result = experiment.EmptyResult();
  for (uint64_t i = samples.first; i < samples.first + samples.count; ++i) {
    MeasureByFixedSteps(experiment, time_step, i, result);
  }
  return EstimateOf(experiment, result, server::ThreadSeconds() - begin);
}

}  // namespace

double HeatCurrentRuns::PredictedSecondsPerReplica(const MethodVariant& variant) const {
  constexpr double kPerStep = 4e-8, kPerHit = 1e-9, kPerEvent = 5e-8, kPerExchange = 4e-7,
                   kPerJump = 4e-8;
  const auto experiment = ExperimentOf(rho_, delta_, seed_, variant.method);
  const GasExperiment& gas = AsGas(*experiment);
  const double time = gas.times().Total();
  if (variant.method == Method::kFixedStep) return kPerStep * time / variant.time_step;
  const SampleWork work = WorkOfReplica(ModelOf(variant.method), gas.geometry(), time);
  if (variant.method == Method::kReference) return kPerEvent * work.Events();
  return kPerHit * work.ball_wall + kPerExchange * work.collisions + kPerJump * work.jumps;
}

PointEstimate HeatCurrentRuns::Run(const MethodVariant& variant, const SampleRange& samples) const {
  const auto experiment = ExperimentOf(rho_, delta_, seed_, variant.method);
  if (variant.method != Method::kFixedStep) return RunSamples(*experiment, samples);
  return RunFixedSteps(AsGas(*experiment), variant.time_step, samples);
}

}  // namespace ballpiston::method_comparison
