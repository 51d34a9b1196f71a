// Flow and gas with fixed time steps, with the interfaces of the event-driven flows and gases.
// Several events of one step are returned one after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/gas/reference_gas.h"
#include "core/gas/thermal_walls.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/fixed_step_flow.h"
#include "tools/flows/fixed_step_gas.h"

namespace ballpiston::stability {

inline constexpr double kTimeStep = 1e-3;

class FixedStepEvents {
 public:
  FixedStepEvents(const PairGeometry& geometry, const PairState& start)
      : flow_(geometry, start, kTimeStep) {}

  // All events of a step but the first one take no time.
  Event Step() {
    double time = 0;
    if (!Anything()) {
      pending_ = flow_.Advance(kLongerThanAnyFlight);
      time = kTimeStep * static_cast<double>(pending_.steps);
    }
    if (!Anything() || Take(pending_.lost)) return {EventKind::kEscape, time};
    if (Take(pending_.ball_wall)) return {EventKind::kBallWall, time};
    if (Take(pending_.piston_wall)) return {EventKind::kPistonWall, time};
    Take(pending_.ball_piston);
    return {EventKind::kBallPiston, time};
  }

  void ExchangeComponents() { flow_.ExchangeComponents(); }
  PairState state() const { return flow_.state(); }

 private:
  static constexpr uint64_t kLongerThanAnyFlight = 1'000'000'000;

  bool Anything() const {
    return pending_.lost || pending_.ball_wall || pending_.piston_wall || pending_.ball_piston;
  }
  static bool Take(bool& flag) { return std::exchange(flag, false); }

  FixedStepFlow flow_;
  FixedSteps pending_ = {};
};

class FixedStepGasEvents {
 public:
  FixedStepGasEvents(const GasGeometry& geometry, const GasState& start, ThermalWalls walls)
      : gas_(geometry, start, std::move(walls), kTimeStep) {}

  // Infinite if nothing happens for a long time.
  double NextTime() {
    constexpr int kMostSteps = 1'000'000;
    for (int i = 0; i < kMostSteps && IsEmpty(); ++i) {
      pending_ = gas_.Advance();
      told_ = 0;
    }
    return IsEmpty() ? std::numeric_limits<double>::infinity() : pending_[told_].time;
  }
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
