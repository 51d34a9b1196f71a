// Measures the relaxation time of the piston's energy in equilibrium, and its cost, by the billiard
// and by the limit of rare collisions (experiment/energy_relaxation.h).
//
// A run of n orbits has samples n ... 2 n - 1 of the point's stream, so runs of 64, 256, 1024, ...
// orbits have no sample in common. The samples of the truth lie between those of the runs. A run is
// one block; it is not divided into chunks and blocks like a job. Properties, each with a test of
// its name:
//   1. RunsHaveNoSampleInCommon, truth included.
//   2. TheJumpProcessAgreesWithTheSpectrum within its error.
#ifndef BALLPISTON_TOOLS_METHOD_COMPARISON_ENERGY_RELAXATION_RUNS_H_
#define BALLPISTON_TOOLS_METHOD_COMPARISON_ENERGY_RELAXATION_RUNS_H_

#include <cstdint>

#include "core/geometry/pair_geometry.h"
#include "tools/method_comparison/method.h"

namespace ballpiston::method_comparison {

struct RelaxationTime {
  double value = 0;
  double error = 0;      // one standard error; for the spectrum that of its discretisation
  uint64_t samples = 0;  // orbits; 0 for the spectrum
  double seconds = 0;    // of processor time
};

// Samples first ... first + count - 1 of a point's stream.
struct SampleRange {
  uint64_t first;
  uint64_t count;  // a power of two, as first is

  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

// The samples of a run; `orbits` is 64, 256, 1024, ...
inline SampleRange RunOf(uint64_t orbits) { return {orbits, orbits}; }
// The samples of the truth; `orbits` is any power of two.
SampleRange TruthOf(uint64_t orbits);

class EnergyRelaxationRuns {
 public:
  EnergyRelaxationRuns(const PairGeometry& geometry, uint64_t seed)
      : geometry_(geometry), seed_(seed) {}

  double delta() const { return geometry_.delta(); }

  // Predicted seconds of one orbit of the billiard in lanes, on a processor of about 3 GHz, within
  // a factor of three.
  double PredictedSecondsPerOrbit() const;

  // By kLanes or kMarkov. Escaped orbits are not counted.
  RelaxationTime Run(Method method, const SampleRange& samples) const;

  // The relaxation time of the limit. `seconds` is the time of one evaluation. It does not include
  // the computation of the spectrum (some 0.1 s), which is done once for all geometries.
  RelaxationTime BySpectrum() const;

 private:
  PairGeometry geometry_;
  uint64_t seed_;
};

}  // namespace ballpiston::method_comparison

#endif  // BALLPISTON_TOOLS_METHOD_COMPARISON_ENERGY_RELAXATION_RUNS_H_
