// Independent replicas of a gas, each followed to the same time.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/gas/canonical_gas.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_run.h"
#include "core/gas/thermal_walls.h"
#include "tools/flows/metered_gases.h"

namespace ballpiston {

struct GasTask {
  GasEngine engine;
  GasGeometry geometry;
  uint64_t replicas;
  double time;
  uint64_t seed;
  double hot = 1, cold = 1;  // T at the ends of the gas
};

// The replica with this number, at its start. Engines have different random numbers.
inline MeteredGases ReplicaOf(const GasTask& task, uint64_t number) {
  const GasGeometry& gas = task.geometry;
  const TemperatureProfile profile(task.hot, task.cold, static_cast<double>(gas.shape().columns));
  const GasRandom random(task.seed, static_cast<uint64_t>(task.engine), number);
  CounterRandom of_start = random.OfStart();
  GasState state = DrawGas(gas, profile, of_start);
  return {task.engine,
          gas,
          {{std::move(state), ThermalWalls(gas, task.hot, task.cold, random), random, nullptr}}};
}

struct GasSamples {
  std::vector<double> exchanges, carried;  // number, and energy, of each replica
  std::vector<double> balls, pistons;      // energy of each body at the end, of all replicas
};

inline GasSamples Measure(const GasTask& task) {
  GasSamples samples;
  for (uint64_t replica = 0; replica < task.replicas; ++replica) {
    MeteredGases run = ReplicaOf(task, replica);
    run.AdvanceTo(task.time);
    GasMeter& meter = run.meters().front();
    meter.End(task.time);
    EXPECT_EQ(meter.escapes(), 0u);
    samples.exchanges.push_back(static_cast<double>(meter.exchanges()));
    samples.carried.push_back(meter.carried());
    for (size_t body = 0; body < meter.bodies(); ++body) {
      (body < meter.balls() ? samples.balls : samples.pistons).push_back(meter.Energy(body));
    }
  }
  return samples;
}

}  // namespace ballpiston
