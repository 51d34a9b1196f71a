// The billiard flow of a ball-piston pair. It computes every event, one at a time, in numbers of
// any precision. Precisions other than double need event_flow-inl.h; tools/flows/precise_flow.h has
// some.
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
//   1. OrbitsKeepTheirEnergyAndStayBetweenWallsAndPiston.  2. OneEventAgreesWithNaiveFlow.
//   3. HorizonGrowsWithTheLogarithmOfThePrecision: in double an orbit is right for about 30 wall
//      hits.
//
// Real is a floating-point type with numeric_limits, sqrt, fabs and copysign (found in std or
// beside the type). The geometry's rho and the piston's walls are the same doubles in every
// precision, rounded if Real has fewer bits. So all precisions compute the same billiard.
//
// Times are in cells over unit speed. One object is one orbit. Not thread-safe.
#pragma once

#include <limits>

#include "core/billiard/cell_walls.h"
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
  EventFlow(const PairGeometry& geometry, const State& state);

  // Moves to the next event, and reflects from walls. At a ball-piston collision the velocities are
  // still those before the collision; ExchangeComponents() must be called before the next Step.
  // kEscape: there is no wall ahead of the ball, which is a defect.
  EventOf<Real> Step();

  // Resolves the ball-piston collision that Step has just reported.
  void ExchangeComponents();

  const State& state() const { return state_; }

 private:
  static constexpr Real Never() { return std::numeric_limits<Real>::infinity(); }

  void AimBall();
  void TimePiston();
  void Advance(Real duration);
  void ReflectBall();
  void ReflectPiston();

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
extern template class EventFlow<double>;

}  // namespace ballpiston
