// Measures the relaxation time of the piston's energy in equilibrium, and its cost, by the billiard
// and by the limit of rare collisions (experiment/energy_relaxation.h).
//
// Runs are those of point_runs.h; a sample is an orbit. A run computes its samples as the service
// would, as one block. Property, with a test of its name:
//   1. TheJumpProcessAgreesWithTheSpectrum within its error.
#pragma once

#include <cstdint>

#include "core/geometry/pair_geometry.h"
#include "tools/method_comparison/method.h"
#include "tools/method_comparison/point_runs.h"

namespace ballpiston::method_comparison {

class EnergyRelaxationRuns {
 public:
  EnergyRelaxationRuns(const PairGeometry& geometry, uint64_t seed)
      : geometry_(geometry), seed_(seed) {}

  double delta() const { return geometry_.delta(); }

  // Predicted seconds of one orbit of the billiard in lanes, on a processor of about 3 GHz, within
  // a factor of three.
  double PredictedSecondsPerOrbit() const;

  // Runs kLanes or kMarkov. Escaped orbits are not counted.
  PointEstimate Run(Method method, const SampleRange& samples) const;

  // The relaxation time of the limit, with its discretisation error. `seconds` is the time of one
  // evaluation, without the computation of the spectrum (about 0.1 s), which is done once for all
  // geometries.
  PointEstimate BySpectrum() const;

 private:
  PairGeometry geometry_;
  uint64_t seed_;
};

}  // namespace ballpiston::method_comparison
