// The base of the experiments with a gas. A replica is a gas that starts from a random state of its
// own. All gases run at temperature 1; results are scaled.
#pragma once

#include <cstdint>
#include <vector>

#include "core/ensemble/chunk_plan.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_run.h"

namespace ballpiston {

// Requires valid parameters.
GasGeometry GasGeometryOf(const PointParameters& point, GasEnds ends);
inline GasGeometry PeriodicGasOf(const PointParameters& point) {
  return GasGeometryOf(point, GasEnds::kPeriodic);
}
inline GasGeometry OpenGasOf(const PointParameters& point) {
  return GasGeometryOf(point, GasEnds::kReservoirs);
}

// The parameters of an experiment with a periodic gas.
inline constexpr ParameterUse kParametersOfAPeriodicGas[] = {
    {&kRho}, {&kDelta}, {&kCells}, {.parameter = &kTemperature, .default_value = 1}};

// Finds deltas beyond the gas's bound at the largest rho, and single precision, which gases do not
// have.
void CheckGasGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found);

// Replicas that a thread computes at the same time in lanes: as many as fill the lanes, but at most
// a quarter of those of the chunk, so that several threads share even a small chunk.
uint64_t TogetherInLanes(int64_t balls, const ChunkPlan& plan, uint64_t chunk);

// The work of a replica at temperature 1 for this duration, in the billiard's units.
SampleWork WorkOfReplica(Model model, const GasGeometry& geometry, double time);

// Upper bound of the bytes of the replicas that a thread computes together.
double MemoryOfReplicas(Model model, const PointParameters& point);

inline constexpr double kRoundingOfTheRate = 0x1p-30;  // see WithoutLastBits

class GasExperiment : public PointExperiment {
 public:
  // A run of gases calls these functions, from any thread.
  GasEngine gas_engine() const;
  const GasGeometry& geometry() const { return geometry_; }
  // At temperature 1; its relative error is kRoundingOfTheRate.
  double exchange_rate() const { return exchange_rate_; }
  GasRandom RandomOf(uint64_t sample) const { return {random().seed, random().stream, sample}; }

 protected:
  // `temperature` is that of the results.
  GasExperiment(const EnsembleSpec& spec, const PointParameters& point, const GasGeometry& geometry,
                double temperature);

  double temperature() const { return temperature_; }

 private:
  GasGeometry geometry_;
  double exchange_rate_;
  double temperature_;
};

}  // namespace ballpiston
