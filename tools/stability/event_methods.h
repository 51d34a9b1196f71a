// A ball moved by a flow that computes one event after the other: EventFlow in any precision, or a
// naive flow with the same interface.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/rounded_to.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

template <typename Flow>
using StateOf = std::remove_cvref_t<decltype(std::declval<Flow>().state())>;
template <typename Flow>
using RealOf = std::remove_cvref_t<decltype(StateOf<Flow>().ball_speed)>;

// At least the epsilon of a double: the watch itself computes in double.
template <typename Flow>
inline constexpr double kEpsilon = std::is_same_v<RealOf<Flow>, float>
                                       ? std::numeric_limits<float>::epsilon()
                                       : std::numeric_limits<double>::epsilon();

// 2 E - 1. For float and double it is computed in 64 bits, so that only the rounding of the state
// remains; else in the number's own precision.
template <typename Real>
double SignedEnergyError(const PairStateOf<Real>& s) {
  using Wide = std::conditional_t<std::is_floating_point_v<Real>, long double, Real>;
  const PairStateOf<Wide> w = RoundedTo<Wide>(s);
  const Wide ball = w.ball_speed * w.ball_speed * w.direction.squaredNorm();
  return static_cast<double>(Wide(ball + w.piston_velocity * w.piston_velocity - 1));
}

template <typename Flow>
void FlyWatched(const PairGeometry& geometry, const PairState& start, uint64_t hits,
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
    const auto& state = flow.state();
    const PairState seen = RoundedTo<double>(state);
    if (!watch.Hit(seen.position, seen.direction, static_cast<double>(event.duration), failures))
      return;
    failures.SeeEnergy(std::fabs(SignedEnergyError(state)));
  }
}

template <typename Flow>
Failures FlyByEvents(const PairGeometry& geometry, std::span<const PairState> starts,
                     uint64_t hits) {
  Failures failures;
  for (const PairState& start : starts) FlyWatched<Flow>(geometry, start, hits, failures);
  return failures;
}

// False if the ball escaped.
template <typename Flow>
bool Step(Flow& flow, uint64_t hits) {
  for (uint64_t i = 0; i < hits; ++i) {
    if (flow.Step().kind != EventKind::kBallWall) return false;
  }
  return true;
}

// The outward unit normal of the disc in the ball's quadrant.
template <typename Real>
typename PairStateOf<Real>::Vector NormalAt(const typename PairStateOf<Real>::Vector& position) {
  using std::sqrt;
  const auto half = [](const Real& x) { return static_cast<Real>(x > 0 ? 0.5 : -0.5); };
  const typename PairStateOf<Real>::Vector from_centre = {position.x() - half(position.x()),
                                                          position.y() - half(position.y())};
  return from_centre / Real(sqrt(from_centre.squaredNorm()));
}

// A start in double, moved onto its wall and with a unit direction in the flow's own precision.
template <typename Real>
PairStateOf<Real> OnWall(const PairGeometry& geometry, const PairState& start) {
  using std::sqrt;
  PairStateOf<Real> state = RoundedTo<Real>(start);
  state.direction /= Real(sqrt(state.direction.squaredNorm()));
  const typename PairStateOf<Real>::Vector normal = NormalAt<Real>(state.position);
  const auto rho = static_cast<Real>(geometry.rho());
  state.position = {static_cast<Real>(start.position.x() > 0 ? 0.5 : -0.5) + rho * normal.x(),
                    static_cast<Real>(start.position.y() > 0 ? 0.5 : -0.5) + rho * normal.y()};
  return state;
}

// The state from which the reversed orbit starts, for a ball on a wall. The reversed velocity is
// reflected at the normal, so that the ball need not hit its present wall first.
template <typename Real>
PairStateOf<Real> Reversed(PairStateOf<Real> state) {
  const typename PairStateOf<Real>::Vector normal = NormalAt<Real>(state.position);
  state.direction = normal * (2 * state.direction.dot(normal)) - state.direction;
  return state;
}

template <typename Flow>
std::vector<double> ThereAndBackByEvents(const PairGeometry& geometry,
                                         std::span<const PairState> starts, uint64_t hits) {
  std::vector<double> distances;
  for (const PairState& start : starts) {
    const auto from = OnWall<RealOf<Flow>>(geometry, start);
    Flow there(geometry, from);
    bool stayed = Step(there, hits);
    Flow back(geometry, Reversed(there.state()));
    stayed = stayed && Step(back, hits);
    const typename StateOf<Flow>::Vector apart = back.state().position - from.position;
    using std::sqrt;
    distances.push_back(stayed ? static_cast<double>(RealOf<Flow>(sqrt(apart.squaredNorm())))
                               : HUGE_VAL);
  }
  return distances;
}

}  // namespace ballpiston::stability
