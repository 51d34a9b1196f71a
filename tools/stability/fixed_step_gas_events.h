// The gas with fixed time steps, with the interface of the event-driven gases.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/gas/reference_gas.h"
#include "core/gas/thermal_walls.h"
#include "tools/flows/fixed_step_gas.h"
#include "tools/stability/fixed_step_events.h"

namespace ballpiston::stability {

class FixedStepGasEvents {
 public:
  FixedStepGasEvents(const GasGeometry& geometry, const GasState& start, ThermalWalls walls)
      : gas_(geometry, start, std::move(walls), FixedStepEvents::kTimeStep) {}

  // Infinite if nothing happens for a long time.
  double NextTime() {
    constexpr int kMostSteps = 1'000'000;
    for (int i = 0; i < kMostSteps && IsEmpty(); ++i) {
      pending_ = gas_.Advance();
      told_ = 0;
    }
    return IsEmpty() ? std::numeric_limits<double>::infinity() : pending_[told_].time;
  }

  // Several events of one step are returned one after the other.
  GasEvent Step() { return pending_[told_++]; }

  GasBall BallAt(int64_t ball, double /*time*/) const { return gas_.BallNow(ball); }
  GasPiston PistonAt(int64_t piston, double /*time*/) const { return gas_.PistonNow(piston); }

 private:
  bool IsEmpty() const { return told_ == pending_.size(); }

  FixedStepGas gas_;
  std::vector<GasEvent> pending_ = {};
  size_t told_ = 0;
};

}  // namespace ballpiston::stability
