// Runs of samples of two experiments: relaxation times of the pair, and heat currents of a gas.
//
// A run is a point that is answered as the service would answer it. Runs of different lengths, and
// the truth, have different seeds. Therefore they have no sample in common.
#pragma once

#include <cstdint>

#include "core/ensemble/ensemble_spec.h"
#include "core/geometry/pair_geometry.h"
#include "tools/method_comparison/method.h"

namespace ballpiston::method_comparison {

// The first estimate of a point.
struct PointEstimate {
  double value = 0;
  double error = 0;      // one standard error; 0 if there are too few samples
  uint64_t samples = 0;  // 0 if the value was computed without samples
  double seconds = 0;    // of processor time
};

// Measures a point of an experiment, and the cost of a sample, by the methods that can run it.
struct PointRuns {
  EnsembleSpec spec;  // one point; without model and samples

  // On a processor of about 3 GHz, within a factor of three. Relaxation times: only by kLanes.
  double PredictedSecondsPerSample(const Method& method) const;

  // By the spectrum, for relaxation times only: without samples; `error` is the bound of its error,
  // and `seconds` the time of one evaluation. The first evaluation includes the time of the
  // spectrum itself (0.1 s), which is computed once for all geometries.
  PointEstimate Run(const Method& method, uint64_t samples) const;

  // By kLanes; with other samples than a run.
  PointEstimate Truth(uint64_t samples) const;
};

// The relaxation time of the piston's energy in equilibrium (experiment/energy_relaxation.h), by
// kLanes, and in the limit of rare collisions by kMarkov and kSpectrum. A sample is an orbit;
// escaped orbits are not counted.
PointRuns RelaxationRuns(const PairGeometry& geometry, uint64_t seed);

// The heat current of one cell between two reservoirs, by FixedSteps, kReference, kLanes and
// kMarkov; delta must be valid for a gas. The gas is that of experiment/gas_conduction.cc, where a
// sample is a measured stretch of half a relaxation time, and all trajectories warm up before their
// first stretch. Stretches are rounded up to a multiple of 128.
//
// The service has no fixed time steps. Their sample is a replica, which starts near local
// equilibrium, relaxes for four relaxation times, and is measured for twelve. A replica that loses
// a ball is not counted. The jump process has the current of the limit, not of the billiard.
// Property, with a test of its name: 1. AllMethodsAgree, within their errors and biases.
PointRuns HeatCurrentRuns(double rho, double delta, uint64_t seed);

}  // namespace ballpiston::method_comparison
