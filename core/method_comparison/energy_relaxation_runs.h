// The relaxation time of the piston's energy in equilibrium, by the billiard and by the limit of
// rare collisions, and what it costs: experiment/energy_relaxation.h, measured.
//
// A run of n orbits is samples n ... 2 n - 1 of the point's stream, so runs of 64, 256, 1024, ...
// orbits have no sample in common; the truth's lie between theirs. A run is blocks of one size,
// which fill the vector lanes, not the some sixteen that a job would be shared out in. Properties,
// each with a test of its name:
//   1. RunsHaveNoSampleInCommon, truth included.
//   2. TheJumpProcessAgreesWithTheSpectrum within its error.
#ifndef BALLPISTON_CORE_METHOD_COMPARISON_ENERGY_RELAXATION_RUNS_H_
#define BALLPISTON_CORE_METHOD_COMPARISON_ENERGY_RELAXATION_RUNS_H_

#include <cstdint>
#include <optional>
#include <stop_token>

#include "core/geometry/pair_geometry.h"
#include "core/method_comparison/method.h"

namespace ballpiston {

struct RelaxationTime {
  double value = 0;
  double error = 0;      // one standard error; of the spectrum, its discretisation's
  uint64_t samples = 0;  // orbits; 0 for the spectrum
  double seconds = 0;    // of processor time
};

// Samples first ... first + count - 1 of a point's stream.
struct SampleRange {
  uint64_t first;
  uint64_t count;  // a power of two, as first is

  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

// A run's; `orbits` is 64, 256, 1024, ...
inline SampleRange RunOf(uint64_t orbits) { return {orbits, orbits}; }
// The truth's; any power of two from 1 on.
SampleRange TruthOf(uint64_t orbits);

class EnergyRelaxationRuns {
 public:
  EnergyRelaxationRuns(const PairGeometry& geometry, uint64_t seed)
      : geometry_(geometry), seed_(seed) {}

  double delta() const { return geometry_.delta(); }

  // What one orbit of the billiard costs in lanes, in seconds, on a processor of 3 GHz or so,
  // within a factor of three.
  double PredictedSecondsPerOrbit() const;

  // By kLanes or kMarkov. Empty if `stop` came before the end. Escaped orbits are not counted.
  std::optional<RelaxationTime> Run(Method method, const SampleRange& samples,
                                    const std::stop_token& stop) const;

  // Of the limit; its time is that of one evaluation. The spectrum itself, some 0.1 s, is made
  // before and once for ever: it is the same for all geometries.
  RelaxationTime BySpectrum() const;

 private:
  PairGeometry geometry_;
  uint64_t seed_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_METHOD_COMPARISON_ENERGY_RELAXATION_RUNS_H_
