// Runs of ball-piston pairs. The runs of an engine are checked at their collisions, those of a flow
// after every event.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "core/billiard/event_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/stability/failures.h"
#include "tools/stability/flow_precision.h"
#include "tools/stability/pair_watch.h"

namespace ballpiston::stability {

template <Engine engine, typename Real>
Failures RunByEngine(const PairGeometry& geometry, std::span<const PairState> starts,
                     uint64_t collisions) {
  CollisionWatch watch(geometry, std::numeric_limits<Real>::epsilon(), starts, collisions);
  RunOrbits(engine, geometry, starts.size(), watch);
  return watch.Finish();
}

template <typename Flow>
void RunPair(const PairGeometry& geometry, const PairState& start, uint64_t collisions,
             Failures& failures) {
  // While a ball of speed 3e-9 crosses the cell, the piston passes about 1e9 times.
  constexpr uint64_t kMostEvents = 10'000'000'000;
  Flow flow(geometry, RoundedTo<RealOf<Flow>>(start));
  PairWatch watch(geometry, kEpsilon<Flow>);
  ++failures.orbits;
  for (uint64_t events = 0; collisions > 0; ++events) {
    if (events == kMostEvents) {
      ++failures.missed;
      return;
    }
    const auto event = flow.Step();
    const auto duration = static_cast<double>(event.duration);
    if (!watch.See(RoundedTo<double>(flow.state()), event.kind, duration, failures)) return;
    failures.SeeEnergy(SignedEnergyError(flow.state()));
    if (event.kind != EventKind::kBallPiston) continue;
    --collisions;
    flow.ExchangeComponents();
    watch.SeeExchanged(RoundedTo<double>(flow.state()), failures);
  }
}

template <typename Flow>
Failures RunByEvents(const PairGeometry& geometry, std::span<const PairState> starts,
                     uint64_t collisions) {
  Failures failures;
  for (const PairState& start : starts) RunPair<Flow>(geometry, start, collisions, failures);
  return failures;
}

}  // namespace ballpiston::stability
