// The flow with fixed time steps, with the interface of the event-driven flows.
#pragma once

#include <cstdint>

#include "core/billiard/event_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/fixed_step_flow.h"

namespace ballpiston::stability {

class FixedStepEvents {
 public:
  static constexpr double kTimeStep = 1e-3;

  FixedStepEvents(const PairGeometry& geometry, const PairState& start)
      : flow_(geometry, start, kTimeStep) {}

  // Several events of one step are returned one after the other; the later ones take no time.
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
  static bool Take(bool& flag) {
    const bool was = flag;
    flag = false;
    return was;
  }

  FixedStepFlow flow_;
  FixedSteps pending_ = {};
};

}  // namespace ballpiston::stability
