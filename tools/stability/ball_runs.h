// Runs of balls alone, in lanes and event by event. Every wall hit is checked.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/lane_balls.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/failures.h"
#include "tools/stability/flow_precision.h"

namespace ballpiston::stability {

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
Failures FlyByEvents(const PairGeometry& geometry, std::span<const PairState> starts,
                     uint64_t hits) {
  Failures failures;
  for (const PairState& start : starts) FlyBall<Flow>(geometry, start, hits, failures);
  return failures;
}

}  // namespace ballpiston::stability
