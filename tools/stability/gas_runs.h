// Runs of gases for the time of so many flights of a ball of speed 1. The runs that report every
// event are checked after each event, the others through their meters.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_run.h"
#include "core/gas/hit_rates.h"
#include "core/gas/reference_gas.h"
#include "tools/stability/failures.h"
#include "tools/stability/gas_watch.h"

namespace ballpiston::stability {

// The lanes report nothing before the requested time. If they take far more processor time than
// usual, they count as one loop. A run on a slow machine must not count as a loop.
inline constexpr double kPatience = 600;  // seconds; usually 2 s are enough for kTogether gases
Failures RunLaneGases(const GasGeometry& geometry, std::span<const GasStart> replicas,
                      uint64_t flights, double patience);
inline Failures RunLaneGases(const GasGeometry& geometry, std::span<const GasStart> replicas,
                             uint64_t flights) {
  return RunLaneGases(geometry, replicas, flights, kPatience);
}

Failures RunJumpGases(const GasGeometry& geometry, std::span<const GasStart> replicas,
                      uint64_t flights);

template <typename Gas>
void RunGas(const GasGeometry& geometry, const GasStart& replica, double end, Failures& failures) {
  // A gas without a loop has far fewer events.
  constexpr uint64_t kMostEvents = 10'000'000;
  Gas gas(geometry, replica.state, replica.walls);
  GasWatch watch(geometry, replica.state, replica.walls, std::numeric_limits<double>::epsilon());
  ++failures.orbits;
  uint64_t events = 0;
  bool goes_on = true;
  for (; goes_on && events < kMostEvents && gas.NextTime() <= end; ++events) {
    const GasEvent event = gas.Step();
    goes_on = watch.See(event, gas.BallAt(std::max<int64_t>(event.ball, 0), event.time),
                        gas.PistonAt(std::max<int64_t>(event.piston, 0), event.time), failures);
  }
  failures.loops += events == kMostEvents;
  failures.SeeEnergy(watch.EnergyError());
}

template <typename Gas>
Failures RunGasesByEvents(const GasGeometry& geometry, std::span<const GasStart> replicas,
                          uint64_t flights) {
  Failures failures;
  const double end = static_cast<double>(flights) * MeanFlight(geometry.pair());
  for (const GasStart& replica : replicas) RunGas<Gas>(geometry, replica, end, failures);
  return failures;
}

}  // namespace ballpiston::stability
