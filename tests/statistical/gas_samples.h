// Many replicas of a gas, measured in the same window of time.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_run.h"
#include "core/gas/thermal_walls.h"
#include "core/statistics/moments.h"

namespace ballpiston {

// Of all replicas.
struct GasSamples {
  Moments rate;               // exchanges of a contact in a unit of time
  Moments current;            // through the cross-section of the gas
  std::vector<double> rates;  // of the replicas
  std::vector<double> currents;
  std::vector<Moments> temperatures;  // of balls, then of pistons: twice that of a piston's mean
  std::vector<std::vector<double>> last;  // energies at the end of the window, by body
};

struct GasTask {
  GasEngine engine;
  GasGeometry geometry;
  double hot = 1;  // T of the whole gas, or of its reservoirs
  double cold = 1;
  uint64_t replicas = 0;
  double begin = 0;  // of the window
  double duration = 0;
};

inline GasSamples Measure(const GasTask& task, uint64_t seed) {
  const GasGeometry& gas = task.geometry;
  const auto columns = static_cast<double>(gas.shape().columns);
  GasSamples samples;
  samples.temperatures.resize(static_cast<size_t>(gas.balls() + gas.pistons()));
  samples.last.resize(samples.temperatures.size());
  for (uint64_t replica = 0; replica < task.replicas; ++replica) {
    const GasRandom random(seed, static_cast<uint64_t>(task.engine), replica);
    CounterRandom of_start = random.OfStart();
    GasState state = DrawGas(gas, TemperatureProfile(task.hot, task.cold, columns), of_start);
    GasMeter meter(gas, state);
    std::vector<GasStart> starts;
    starts.push_back(
        {std::move(state), ThermalWalls(gas, task.hot, task.cold, random), random, &meter});
    const std::unique_ptr<GasRun> run =
        StartGases(task.engine, gas, GasExchangeRate(gas, 1), std::move(starts));
    run->AdvanceTo(task.begin);
    meter.Begin(task.begin);
    run->AdvanceTo(task.begin + task.duration);
    meter.End(task.begin + task.duration);
    EXPECT_EQ(meter.escapes(), 0u);
    samples.rates.push_back(static_cast<double>(meter.exchanges()) / task.duration /
                            static_cast<double>(gas.contacts()));
    samples.rate.Add(samples.rates.back());
    // Every cell has two contacts along x for each row, and each of them carries the current.
    samples.currents.push_back(meter.carried() / task.duration / (2 * columns));
    samples.current.Add(samples.currents.back());
    for (size_t body = 0; body < meter.bodies(); ++body) {
      const double per_temperature = body < meter.balls() ? 1 : 2;
      samples.temperatures[body].Add(per_temperature * meter.MeanEnergy(body));
      samples.last[body].push_back(meter.Energy(body));
    }
  }
  return samples;
}

// The last energies of bodies from `first` to before `last`, of all replicas.
inline std::vector<double> LastEnergies(const GasSamples& samples, size_t first, size_t last) {
  std::vector<double> energies;
  for (size_t body = first; body < last; ++body) {
    energies.insert(energies.end(), samples.last[body].begin(), samples.last[body].end());
  }
  return energies;
}

// Standard errors between a mean and its expectation, which may have a standard error of its own.
inline double StandardErrorsOff(const Moments& moments, double expected, double its_error = 0) {
  return std::fabs(moments.mean - expected) /
         std::hypot(moments.StandardError().value(), its_error);
}

}  // namespace ballpiston
