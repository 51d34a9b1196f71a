// The billiard flow of a ball-piston pair. It computes every event, one at a time, in numbers of
// any precision (tools/flows/precise_flow.h).
//
// The ball flies straight between the four arcs, the piston between its two walls. When ball and
// piston meet, they exchange horizontal velocity components. The method is stable because:
//   - The direction after a wall hit follows from the impact parameter c = u x (centre - ball):
//     with s = sqrt(rho^2 - c^2) it is (s n + c t)/rho, n and t normal and tangent at the hit. It
//     has length 1 by construction. The reflection u - 2 (u.n) n would couple the error of |u| to
//     that of the position and amplify it.
//   - The disc just hit is excluded from the next flight. If rounding puts the ball an ulp inside a
//     neighbouring disc, the ball hits this disc at once, at time 0. So no orbit leaves through a
//     tip.
//   - After an exchange the smaller of the two speeds is computed, and the larger follows from the
//     energy. So the energy stays 1/2 to an ulp for ever, and a slow ball keeps all its digits.
// Properties, each with a test of its name:
//   1. OrbitsKeepTheirEnergyAndStayBetweenWallsAndPiston.
//   2. LanesMeetThePistonWhereTheReferenceDoes.
//   3. HorizonGrowsWithTheLogarithmOfThePrecision: in double an orbit is right for about 30 wall
//      hits.
//
// Real is a floating-point type with numeric_limits, sqrt, fabs and copysign (found in std or
// beside the type). The geometry's rho and the piston's walls are the same doubles in every
// precision, rounded if Real has fewer bits. So all precisions compute the same billiard.
//
// Times are in cells over unit speed. One object is one orbit. Not thread-safe.
#pragma once

#include <algorithm>
#include <limits>

#include "core/billiard/cell_walls.h"
#include "core/billiard/exchange.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

enum class EventKind { kBallWall, kPistonWall, kBallPiston, kEscape };

template <typename Real>
struct EventOf {
  EventKind kind;
  Real duration;  // time since the previous event, >= 0
};

using Event = EventOf<double>;

template <typename Real>
class EventFlow {
 public:
  using State = PairStateOf<Real>;

  // A state inside Gamma. A state on the boundary of Gamma that is about to leave has an event at
  // time 0.
  EventFlow(const PairGeometry& geometry, const State& state)
      : walls_(geometry),
        piston_left_(static_cast<Real>(geometry.piston_left())),
        piston_right_(static_cast<Real>(geometry.piston_right())),
        state_(state) {
    AimBall();
    TimePiston();
  }

  // Moves to the next event, and reflects from walls. At a ball-piston collision the velocities are
  // still those before the collision; ExchangeComponents() must be called before the next Step.
  // kEscape: there is no wall ahead of the ball, which is a defect.
  EventOf<Real> Step() {
    const bool wall_first = time_to_wall_ <= time_to_piston_wall_;
    Real duration = wall_first ? time_to_wall_ : time_to_piston_wall_;
    const Real approach = state_.ball_speed * state_.direction.x() - state_.piston_velocity;
    const Real gap = std::max(state_.piston - state_.position.x(), Real(0));
    // <= includes a collision at the moment when the piston turns: the piston may never come nearer
    // to a ball at rest.
    if (approach > 0 && gap <= approach * duration) {
      duration = gap / approach;
      Advance(duration);
      return {EventKind::kBallPiston, duration};
    }
    if (encounter_.disc == kNoDisc && state_.ball_speed > 0) return {EventKind::kEscape, 0};
    Advance(duration);
    if (wall_first) {
      ReflectBall();
      return {EventKind::kBallWall, duration};
    }
    ReflectPiston();
    return {EventKind::kPistonWall, duration};
  }

  // Resolves the ball-piston collision that Step has just reported.
  void ExchangeComponents() {
    state_ = AfterExchange(state_, Real(1));
    last_disc_ = kNoDisc;
    AimBall();
    TimePiston();
  }

  const State& state() const { return state_; }

 private:
  static constexpr Real Never() { return std::numeric_limits<Real>::infinity(); }

  void Advance(Real duration) {
    state_.position += state_.direction * (state_.ball_speed * duration);
    state_.piston += state_.piston_velocity * duration;
    time_to_wall_ -= duration;
    time_to_piston_wall_ -= duration;
  }

  void ReflectBall() {
    walls_.Reflect(encounter_, state_.position, state_.direction);
    last_disc_ = encounter_.disc;
    AimBall();
  }

  void ReflectPiston() {
    state_.piston = state_.piston_velocity > 0 ? piston_right_ : piston_left_;
    state_.piston_velocity = -state_.piston_velocity;
    TimePiston();
  }

  void AimBall() {
    encounter_ = walls_.Next(state_.position, state_.direction, last_disc_);
    time_to_wall_ = state_.ball_speed > 0 ? encounter_.distance / state_.ball_speed : Never();
  }

  void TimePiston() {
    const Real velocity = state_.piston_velocity;
    const Real wall = velocity > 0 ? piston_right_ : piston_left_;
    time_to_piston_wall_ =
        velocity == 0 ? Never() : std::max((wall - state_.piston) / velocity, Real(0));
  }

  CellWalls<Real> walls_;
  Real piston_left_;
  Real piston_right_;

  State state_;
  int last_disc_ = kNoDisc;  // the disc on which the ball is, if any
  typename CellWalls<Real>::Encounter encounter_ = {};
  Real time_to_wall_ = 0;         // the ball's
  Real time_to_piston_wall_ = 0;  // the piston's
};

// In double precision. Every faster engine is compared with it, and traces use it.
using ReferenceFlow = EventFlow<double>;

}  // namespace ballpiston
