// Runs of samples of two experiments: relaxation times of the pair, and heat currents of a gas.
//
// A run of n samples has the samples n ... 2 n - 1 of the point's stream. Therefore runs of 64,
// 256, 1024, ... samples have no sample in common. The samples of the truth are in the gaps between
// the runs. Property, with a test of its name: 1. RunsHaveNoSampleInCommon, truth included.
#pragma once

#include <bit>
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

// Samples first ... first + count - 1 of a point's stream.
struct SampleRange {
  uint64_t first;
  uint64_t count;  // a power of two, like first

  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

// The samples of a run; `samples` is 64, 256, 1024, ...
inline SampleRange RunOf(uint64_t samples) { return {samples, samples}; }
// The samples of the truth; `samples` is any power of two.
inline SampleRange TruthOf(uint64_t samples) {
  // The runs are [4^k, 2 4^k). The gap that starts at 2 4^k has the same length.
  const bool is_start_of_run = std::countr_zero(samples) % 2 == 0;
  return {is_start_of_run ? 2 * samples : samples, samples};
}

// Measures the relaxation time of the piston's energy in equilibrium, and its cost, by the billiard
// and by the limit of rare collisions (experiment/energy_relaxation.h).
//
// A sample is an orbit. A run computes its samples as the service would, as one block. Property,
// with a test of its name: 1. TheJumpProcessAgreesWithTheSpectrum within its error.
struct EnergyRelaxationRuns {
  PairGeometry geometry;
  uint64_t seed;

  // Predicted seconds of one orbit of the billiard in lanes, on a processor of about 3 GHz, within
  // a factor of three.
  double PredictedSecondsPerOrbit() const;

  // Runs kLanes or kMarkov. Escaped orbits are not counted.
  PointEstimate Run(Method method, const SampleRange& samples) const;

  // The relaxation time of the limit, with the bound of its error. `seconds` is the time of one
  // evaluation, without the computation of the spectrum (about 0.1 s), which is done once for all
  // geometries.
  PointEstimate BySpectrum() const;
};

// Measures the heat current of one cell between two reservoirs, and its cost, by the methods that
// can run a gas. A sample is a replica of the gas of experiment/gas_conduction.cc. It starts near
// local equilibrium, relaxes for four relaxation times, and is measured for twelve.
//
// All methods run the same replicas for the same times. A replica of the fixed time steps that
// loses a ball is not counted. The jump process has the current of the limit, not of the billiard.
// Property, with a test of its name: 1. AllMethodsAgree, within their errors and biases.
struct HeatCurrentRuns {
  double rho;
  double delta;  // valid for a gas
  uint64_t seed;

  // For kFixedStep, kReference, kLanes and kMarkov, on a processor of about 3 GHz, within a factor
  // of three.
  double PredictedSecondsPerReplica(const MethodVariant& variant) const;

  // Runs one of these methods.
  PointEstimate Run(const MethodVariant& variant, const SampleRange& samples) const;
};

}  // namespace ballpiston::method_comparison
