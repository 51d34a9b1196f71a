// Checked runs of balls alone and of ball-piston pairs. An engine's balls are checked at their wall
// hits and its pairs at their collisions, a flow after every event.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/lane_balls.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/failures.h"
#include "tools/stability/flow_precision.h"
#include "tools/stability/pair_watch.h"

namespace ballpiston::stability {

// ---- engines ----

template <FlyLanes& fly, typename Real>
Failures FlyInLanes(const PairGeometry& geometry, std::span<const PairState> starts,
                    uint64_t hits) {
  std::vector<LaneFrame> frames = OnTheirWalls(starts);
  std::vector<LaneHit> hit(starts.size());
  std::vector<BallWatch> watches(starts.size(),
                                 BallWatch(geometry, std::numeric_limits<Real>::epsilon()));
  std::vector<char> flies(starts.size(), 1);
  size_t flying = starts.size();
  Failures failures = {.orbits = starts.size()};
  for (uint64_t i = 0; i < hits && flying > 0; ++i) {
    fly(geometry, frames, 1, hit);
    for (size_t k = 0; k < frames.size(); ++k) {
      const auto& [frame, length, x] = hit[k];
      frames[k] = frame;
      if (!flies[k]) continue;
      failures.SeeEnergy(SignedEnergyError(frame));
      flies[k] = watches[k].Hit(PositionInCell(frame), DirectionInCell(frame), length, failures);
      flying -= !flies[k];
    }
  }
  return failures;
}

template <Engine engine, typename Real>
Failures RunByEngine(const PairGeometry& geometry, std::span<const PairState> starts,
                     uint64_t collisions) {
  CollisionWatch watch(geometry, std::numeric_limits<Real>::epsilon(), starts, collisions);
  RunOrbits(engine, geometry, starts.size(), watch);
  return watch.Finish();
}

// ---- flows ----

template <typename Flow>
void FlyBall(const PairGeometry& geometry, const PairState& start, uint64_t hits,
             Failures& failures) {
  Flow flow(geometry, RoundedTo<RealOf<Flow>>(start));
  BallWatch watch(geometry, kEpsilon<Flow>);
  ++failures.orbits;
  for (uint64_t i = 0; i < hits; ++i) {
    const auto event = flow.Step();
    if (event.kind == EventKind::kEscape) {
      ++failures.escapes;
      return;
    }
    const PairState seen = RoundedTo<double>(flow.state());
    const auto length = static_cast<double>(event.duration);
    if (!watch.Hit(seen.position, seen.direction, length, failures)) return;
    failures.SeeEnergy(SignedEnergyError(flow.state()));
  }
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
Failures FlyByEvents(const PairGeometry& geometry, std::span<const PairState> starts,
                     uint64_t hits) {
  Failures failures;
  for (const PairState& start : starts) FlyBall<Flow>(geometry, start, hits, failures);
  return failures;
}

template <typename Flow>
Failures RunByEvents(const PairGeometry& geometry, std::span<const PairState> starts,
                     uint64_t collisions) {
  Failures failures;
  for (const PairState& start : starts) RunPair<Flow>(geometry, start, collisions, failures);
  return failures;
}

}  // namespace ballpiston::stability
