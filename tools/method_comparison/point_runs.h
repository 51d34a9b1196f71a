// Runs of samples of two experiments: relaxation times of the pair, and heat currents of a gas.
//
// A run is a point that is answered as the service would answer it. Runs of different lengths, and
// the truth, have different seeds. Therefore they have no sample in common.
#pragma once

#include <cstdint>

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

// Measures the relaxation time of the piston's energy in equilibrium, and its cost, by the billiard
// and by the limit of rare collisions (experiment/energy_relaxation.h).
//
// A sample is an orbit.
struct EnergyRelaxationRuns {
  PairGeometry geometry;
  uint64_t seed;

  // Predicted seconds of one orbit of the billiard in lanes, on a processor of about 3 GHz, within
  // a factor of three.
  double PredictedSecondsPerOrbit() const;

  // Runs kLanes or kMarkov. Escaped orbits are not counted.
  PointEstimate Run(const Method& method, uint64_t samples) const;

  // By kLanes; with other samples than a run.
  PointEstimate Truth(uint64_t samples) const;

  // The relaxation time of the limit, with the bound of its error. `seconds` is the time of one
  // evaluation, without the computation of the spectrum (about 0.1 s), which is done once for all
  // geometries.
  PointEstimate BySpectrum() const;
};

// Measures the heat current of one cell between two reservoirs, and its cost, by the methods that
// can run a gas. The gas is that of experiment/gas_conduction.cc, where a sample is a measured
// stretch of half a relaxation time, and all trajectories warm up before their first stretch.
//
// The service has no fixed time steps. Their sample is a replica, which starts near local
// equilibrium, relaxes for four relaxation times, and is measured for twelve. A replica that loses
// a ball is not counted. The jump process has the current of the limit, not of the billiard.
// Property, with a test of its name: 1. AllMethodsAgree, within their errors and biases.
struct HeatCurrentRuns {
  double rho;
  double delta;  // valid for a gas
  uint64_t seed;

  // For FixedSteps, kReference, kLanes and kMarkov, on a processor of about 3 GHz, within a factor
  // of three.
  double PredictedSecondsPerSample(const Method& method) const;

  // Runs one of these methods. Stretches are rounded up to a multiple of 128.
  PointEstimate Run(const Method& method, uint64_t samples) const;

  // By kLanes; with other samples than a run.
  PointEstimate Truth(uint64_t samples) const;
};

}  // namespace ballpiston::method_comparison
