// Orbits of many pairs by any method, from collision to collision (see billiard/orbits.h). An orbit
// that is lost, or whose time no longer advances, ends with an escape.
#pragma once

#include <cstdint>

#include "core/billiard/event_flow.h"
#include "core/billiard/orbits.h"
#include "core/geometry/pair_geometry.h"
#include "tools/flows/fixed_step_flow.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/flows/rounded_to.h"
#include "tools/method_comparison/method.h"

namespace ballpiston::method_comparison {

// One orbit of a flow in any precision.
template <typename Real>
class EventOrbit {
 public:
  EventOrbit(const PairGeometry& geometry, const PairStateOf<Real>& start)
      : flow_(geometry, start) {}

  // Makes one event, and adds it to the way to the next collision. True if this is reached, or if
  // the orbit is lost.
  bool Advance(Collision& collision) {
    const EventOf<Real> event = flow_.Step();
    collision.Add({event.kind, static_cast<double>(event.duration)});
    standing_ = event.duration > 0 ? 0 : standing_ + 1;
    collision.escaped = collision.escaped || standing_ > kStandsStill;
    return collision.escaped || event.kind == EventKind::kBallPiston;
  }
  PairState state() const { return RoundedTo<double>(flow_.state()); }
  void ExchangeComponents() { flow_.ExchangeComponents(); }

 private:
  static constexpr int kStandsStill = 1000;  // successive events at the same time

  EventFlow<Real> flow_;
  int standing_ = 0;
};

// The same with fixed time steps: makes steps up to the next events, or many steps.
class FixedStepOrbit {
 public:
  FixedStepOrbit(const PairGeometry& geometry, const PairState& start, double time_step)
      : flow_(geometry, start, time_step), time_step_(time_step) {}

  bool Advance(Collision& collision) {
    constexpr uint64_t kMostSteps = 1024;
    const FixedSteps done = flow_.Advance(kMostSteps);
    steps_ += done.steps;
    collision.time = static_cast<double>(steps_) * time_step_;
    collision.ball_wall_hits += done.ball_wall;
    collision.piston_wall_hits += done.piston_wall;
    collision.escaped = done.lost;
    return done.lost || done.ball_piston;
  }
  PairState state() const { return flow_.state(); }
  void ExchangeComponents() {
    flow_.ExchangeComponents();
    steps_ = 0;
  }

 private:
  FixedStepFlow flow_;
  double time_step_;
  uint64_t steps_ = 0;
};

// Not for kClosedForm, kMarkov and kSpectrum, which have no such orbits. Starts and collisions are
// doubles; between them all numbers have the method's precision.
void RunMethodOrbits(const MethodVariant& variant, const PairGeometry& geometry, uint64_t orbits,
                     NumberedOrbits& source);

}  // namespace ballpiston::method_comparison
