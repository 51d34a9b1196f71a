// The base of the experiments with a gas, and of those whose sample is a replica of the gas, which
// starts from a random state of its own. All gases run at temperature 1; results are scaled.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_run.h"

namespace ballpiston {

// Requires valid parameters.
GasGeometry GasGeometryOf(const PointParameters& point, GasEnds ends);
inline GasGeometry PeriodicGasOf(const PointParameters& point) {
  return GasGeometryOf(point, GasEnds::kPeriodic);
}

// The parameters of an experiment with a periodic gas.
inline constexpr ParameterUse kParametersOfAPeriodicGas[] = {
    {&kRho}, {&kDelta}, {&kCells}, {.parameter = &kTemperature, .default_value = 1}};

// Finds deltas beyond the gas's bound at the largest rho, and single precision, which gases do not
// have.
void CheckGasGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found);

// The work of a replica at temperature 1 for this duration, in the billiard's units.
SampleWork WorkOfReplica(Model model, const GasGeometry& geometry, double time);

// Upper bound of the bytes of the replicas that a thread computes together.
double MemoryOfReplicas(Model model, const PointParameters& point);

class GasExperiment : public PointExperiment {
 public:
  // A run of gases calls these functions, from any thread.
  GasEngine gas_engine() const;
  const GasGeometry& geometry() const { return geometry_; }
  // At temperature 1.
  double exchange_rate() const { return exchange_rate_; }
  GasRandom RandomOf(uint64_t sample) const { return {random().seed, random().stream, sample}; }
  virtual TemperatureProfile TemperaturesAtStart() const = 0;
  virtual ThermalWalls WallsOf(const GasRandom&) const { return {}; }

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

class GasReplicas : public GasExperiment {
 public:
  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override;

  double duration() const { return duration_; }  // of a replica, at temperature 1
  // A meter of the current of a replica with this start; null if the current is not measured.
  virtual std::unique_ptr<CurrentMeter> CurrentOf(const GasState&) const { return nullptr; }
  // Adds a replica's numbers.
  virtual void Measure(const GasMeter& meter, BlockResult& result) const = 0;

 protected:
  // Rounds the duration (WithoutLastBits), because its last bits depend on the C library.
  GasReplicas(const EnsembleSpec& spec, const PointParameters& point, const GasGeometry& geometry,
              double duration, double temperature);

 private:
  double duration_;
};

}  // namespace ballpiston
