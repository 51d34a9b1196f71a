// What the experiments with a gas share: replicas of the gas, each started on its own, followed for
// some time and then measured. A sample is one replica.
#ifndef BALLPISTON_CORE_EXPERIMENT_GAS_EXPERIMENT_H_
#define BALLPISTON_CORE_EXPERIMENT_GAS_EXPERIMENT_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_run.h"

namespace ballpiston {

inline constexpr Model kModelsOfGases[] = {Model::kMarkov, Model::kBilliard,
                                           Model::kBilliardReference};

// Requires valid parameters.
GasGeometry GasGeometryOf(const PointParameters& point, GasEnds ends);

// Finds deltas beyond the gas's bound at the largest rho, and single precision, which gases do not
// have.
void CheckGasGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found);

// How long a replica is followed, in the billiard's units at temperature 1.
struct GasTimes {
  double relax = 0;  // before anything is measured
  double measure = 0;

  double Total() const { return relax + measure; }
};

// The work of a replica at temperature 1 that is followed so long.
SampleWork WorkOfReplica(Model model, const GasGeometry& geometry, double time);

class GasExperiment : public PointExperiment {
 public:
  std::unique_ptr<BlockRun> StartRun(BlockQueue& queue) const override;

  // What a run of replicas asks for, from any thread.
  GasEngine gas_engine() const;
  const GasGeometry& geometry() const { return geometry_; }
  const GasTimes& times() const { return times_; }
  GasRandom RandomOf(uint64_t sample) const { return {random().seed, random().stream, sample}; }
  virtual GasState Draw(CounterRandom& random) const = 0;
  virtual ThermalWalls WallsOf(const GasRandom&) const { return {}; }
  // Adds one replica's numbers.
  virtual void Measure(const GasMeter& meter, BlockResult& result) const = 0;

 protected:
  GasExperiment(const EnsembleSpec& spec, const PointParameters& point, const GasGeometry& geometry,
                const GasTimes& times)
      : PointExperiment(spec, point), geometry_(geometry), times_(times) {}

 private:
  GasGeometry geometry_;
  GasTimes times_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_GAS_EXPERIMENT_H_
