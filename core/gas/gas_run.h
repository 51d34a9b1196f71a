// Gases in motion: one interface for the engines.
//
//   kReference  computes every event of every ball and piston, one at a time (reference_gas.h).
//   kLanes      the same gas, with the flights of many balls in vector lanes (lane_gas.h).
//   kJumps      the limit of rare collisions: a jump process of the energies (jump_gas.h).
//
// A replica's numbers depend only on its start, not on the times of the calls or on other
// replicas.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_state.h"
#include "core/gas/thermal_walls.h"

namespace ballpiston {

enum class GasEngine { kReference, kLanes, kJumps };

// A gas at time 0.
struct GasStart {
  GasState state;
  ThermalWalls walls;
  GasRandom random;
};

class GasRun {
 public:
  virtual ~GasRun() = default;
  // Moves all replicas toward `time`, which must not be less than in the previous call. Returns
  // true when all are there, false after some 2 ms; then it must be called again with the same
  // time.
  virtual bool AdvanceToward(double time) = 0;
  void AdvanceTo(double time) {
    while (!AdvanceToward(time)) continue;
  }
  // The positions and velocities of a replica at the time to which AdvanceTo has moved it, from
  // which another run can continue. The jump process has speeds alone.
  virtual GasState StateOf(size_t replica) const = 0;

  // The meters in the order of the replicas, valid as long as the run. They measure from time 0, or
  // from the last call of Begin.
  std::span<GasMeter> meters() { return meters_; }

 protected:
  GasRun(const GasGeometry& geometry, const std::vector<GasStart>& replicas) {
    meters_.reserve(replicas.size());
    for (const GasStart& start : replicas) meters_.emplace_back(geometry, start.state);
  }

 private:
  std::vector<GasMeter> meters_;
};

// `exchange_rate` is that of the gas at temperature 1 (gas_exchange_rate.h). It determines the
// rates of the jump process. In lanes it determines only how far balls fly ahead, which changes no
// result.
std::unique_ptr<GasRun> StartGases(GasEngine engine, const GasGeometry& geometry,
                                   double exchange_rate, std::vector<GasStart> replicas);

}  // namespace ballpiston
