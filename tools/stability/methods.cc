#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/gas/reference_gas.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/energy_error.h"
#include "tools/flows/fixed_step_flow.h"
#include "tools/flows/fixed_step_gas.h"
#include "tools/flows/lane_balls.h"
#include "tools/flows/precise_flow.h"
#include "tools/flows/rounded_to.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/case.h"
#include "tools/stability/failures.h"
#include "tools/stability/gas_watch.h"
#include "tools/stability/pair_watch.h"
#include "tools/stability/textbook_flow.h"

namespace ballpiston::stability {
namespace {

// At least the epsilon of a double: the checks themselves are computed in double.
template <typename Flow>
inline constexpr double kEpsilonOf = std::is_same_v<RealOf<Flow>, float>
                                         ? std::numeric_limits<float>::epsilon()
                                         : std::numeric_limits<double>::epsilon();

// ---- checked runs of balls alone and of ball-piston pairs ----
//
// An engine's balls are checked at their wall hits and its pairs at their collisions, a flow after
// every event.

template <FlyLanes& fly, typename Real>
Failures FlyInLanes(const PairGeometry& geometry, std::span<const PairState> starts,
                    uint64_t hits) {
  std::vector<LaneFrame> frames = OnTheirWalls(starts);
  std::vector<LaneHit> hit(starts.size());
  std::vector<BallWatch> watches(starts.size(),
                                 BallWatch(geometry, std::numeric_limits<Real>::epsilon()));
  std::vector<char> flies(starts.size(), 1);
  std::vector<double> middle(starts.size()), last(starts.size());  // dE/E
  size_t flying = starts.size();
  Failures failures = {.orbits = starts.size()};
  for (uint64_t i = 0; i < hits && flying > 0; ++i) {
    fly(geometry, frames, 1, hit);
    for (size_t k = 0; k < frames.size(); ++k) {
      const auto& [frame, length, x] = hit[k];
      frames[k] = frame;
      if (!flies[k]) continue;
      last[k] = SignedEnergyError(frame);
      if (i <= hits / 2) middle[k] = last[k];
      failures.SeeEnergy(last[k]);
      flies[k] = watches[k].Hit(PositionInCell(frame), DirectionInCell(frame), length, failures);
      flying -= !flies[k];
    }
  }
  for (size_t k = 0; k < frames.size(); ++k) {
    if (flies[k]) failures.gain.Add(last[k] - middle[k]);
  }
  return failures;
}

template <Engine engine, typename Real>
Failures RunByEngine(const PairGeometry& geometry, std::span<const PairState> starts,
                     uint64_t collisions) {
  CollisionWatch watch(geometry, std::numeric_limits<Real>::epsilon(), starts, collisions);
  watch.Run(engine, geometry, starts.size());
  return watch.Finish();
}

template <typename Flow>
void FlyBall(const PairGeometry& geometry, const PairState& start, uint64_t hits,
             Failures& failures) {
  Flow flow(geometry, RoundedTo<RealOf<Flow>>(start));
  BallWatch watch(geometry, kEpsilonOf<Flow>);
  ++failures.orbits;
  double middle = 0, last = 0;  // dE/E
  for (uint64_t i = 0; i < hits; ++i) {
    const auto event = flow.Step();
    if (event.kind == EventKind::kEscape) {
      ++failures.escapes;
      return;
    }
    const PairState seen = RoundedTo<double>(flow.state());
    const auto length = static_cast<double>(event.duration);
    if (!watch.Hit(seen.position, seen.direction, length, failures)) return;
    last = SignedEnergyError(flow.state());
    if (i <= hits / 2) middle = last;
    failures.SeeEnergy(last);
  }
  failures.gain.Add(last - middle);
}

template <typename Flow>
void RunPair(const PairGeometry& geometry, const PairState& start, uint64_t collisions,
             Failures& failures) {
  // While a ball of speed 3e-9 crosses the cell, the piston passes about 1e9 times.
  constexpr uint64_t kMostEvents = 10'000'000'000;
  Flow flow(geometry, RoundedTo<RealOf<Flow>>(start));
  PairWatch watch(geometry, kEpsilonOf<Flow>);
  ++failures.orbits;
  double middle = 0, last = 0;  // dE/E
  for (uint64_t events = 0, left = collisions; left > 0; ++events) {
    if (events == kMostEvents) {
      ++failures.missed;
      return;
    }
    const auto event = flow.Step();
    const auto duration = static_cast<double>(event.duration);
    if (!watch.See(RoundedTo<double>(flow.state()), event.kind, duration, failures)) return;
    last = SignedEnergyError(flow.state());
    if (left > collisions / 2) middle = last;
    failures.SeeEnergy(last);
    if (event.kind != EventKind::kBallPiston) continue;
    --left;
    flow.ExchangeComponents();
    watch.SeeExchanged(RoundedTo<double>(flow.state()), failures);
  }
  failures.gain.Add(last - middle);
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

}  // namespace

std::vector<PairMethod> BallMethods() {
  using enum TextbookRule;
  return {
      {"lanes", 1, true, FlyInLanes<FlyLaneBalls, double>},
      {"lanes, single", 0.1, false, FlyInLanes<FlyLaneBallsSingle, float>},
      {"reference", 1, true, FlyByEvents<ReferenceFlow>},
      {"reference, single", 0.02, false, FlyByEvents<EventFlow<float>>},
      {"reference, 64 bits", 0.02, true, FlyByEvents<EventFlow<long double>>},
      {"reference, 113 bits", 2e-4, true, FlyByEvents<EventFlow<Quad>>},
      {"nearest root", 0.01, false, FlyByEvents<TextbookFlow<kPositiveRoot>>},
      {"nearest root, no threshold", 0.01, false, FlyByEvents<TextbookFlow<kAnyRoot>>},
      {"approaching disc", 0.01, false, FlyByEvents<TextbookFlow<kApproaching>>},
      {"unit speed assumed", 0.01, false, FlyByEvents<TextbookFlow<kUnitSpeed>>},
      {"fixed steps of 1e-3", 1e-3, false, FlyByEvents<FixedStepFlow>},
  };
}

std::vector<PairMethod> PairMethods() {
  using enum TextbookRule;
  // At smaller delta the positions of methods without promise are too inexact for the checks.
  const auto large = [](const PairGeometry& geometry) { return geometry.delta() >= 1e-3; };
  return {
      {"lanes", 1, true, RunByEngine<Engine::kLanes, double>},
      {"lanes, single", 0.1, false, RunByEngine<Engine::kLanesSingle, float>, large},
      {"reference", 1, true, RunByEvents<ReferenceFlow>},
      {"reference, single", 0.02, false, RunByEvents<EventFlow<float>>, large},
      {"reference, 64 bits", 0.02, true, RunByEvents<EventFlow<long double>>},
      {"reference, 113 bits", 1e-3, true, RunByEvents<EventFlow<Quad>>},
      {"nearest root", 0.02, false, RunByEvents<TextbookFlow<kPositiveRoot>>, large},
      {"nearest root, no threshold", 0.02, false, RunByEvents<TextbookFlow<kAnyRoot>>, large},
      {"approaching disc", 0.02, false, RunByEvents<TextbookFlow<kApproaching>>, large},
      {"fixed steps of 1e-3", 2e-4, false, RunByEvents<FixedStepFlow>, large},
  };
}

std::vector<GasMethod> GasMethods() {
  return {
      {"lanes", 1, true, RunGasesByMeters<GasEngine::kLanes>},
      {"reference", 1, true, RunGasesByEvents<ReferenceGas>},
      {"jump process", 1, true, RunGasesByMeters<GasEngine::kJumps>},
      {"fixed steps of 1e-3", 0.01, false, RunGasesByEvents<FixedStepGas>},
  };
}

}  // namespace ballpiston::stability
