// The billiard flow of a ball-piston pair, every event resolved, one at a time, in numbers of any
// precision. In double it is ReferenceFlow (reference_flow.h), the yardstick for every faster
// engine; a further one needs event_flow-inl.h: tools/flows/precise_flow.h has some.
//
// The ball flies straight between the four arcs, the piston between its two walls; when they meet
// they exchange horizontal velocity components. What keeps it stable:
//   - The direction after a wall hit comes from the impact parameter c = u x (centre - ball):
//     with s = sqrt(rho^2 - c^2) it is (s n + c t)/rho, n and t normal and tangent at the hit. It
//     has length 1 by construction; reflecting u - 2 (u.n) n couples the error of |u| to that of
//     the position and amplifies it.
//   - The disc just hit is excluded from the next flight, and a ball that rounding left an ulp
//     inside a neighbouring disc hits it at once, at time 0: no orbit leaves through a tip.
//   - Of the two speeds after an exchange the smaller is computed, the larger follows from the
//     energy, so the energy stays 1/2 to an ulp for ever, and a slow ball keeps all its digits.
// Properties, each with a test of its name: 1. EnergyStaysExact. 2. BallStaysInCell.
// 3. ReversedVelocityRetracesOrbit, as far as rounding lets it (in double some 30 wall hits).
// 4. PistonStaysRightOfBall. 5. ErrorsShrinkWithThePrecision.
//
// Real is a floating-point type with numeric_limits, sqrt, fabs and copysign (found in std or
// beside the type). The geometry's rho and the piston's walls are those doubles in every precision,
// rounded where Real has fewer bits: so all precisions compute the same billiard.
//
// Times are in cells per unit speed. One object is one orbit; not for sharing between threads.
#ifndef BALLPISTON_CORE_BILLIARD_EVENT_FLOW_H_
#define BALLPISTON_CORE_BILLIARD_EVENT_FLOW_H_

#include <limits>

#include "core/billiard/cell_walls.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

enum class EventKind { kBallWall, kPistonWall, kBallPiston, kEscape };

template <typename Real>
struct EventOf {
  EventKind kind;
  Real duration;  // time since the event before, >= 0
};

using Event = EventOf<double>;

template <typename Real>
class EventFlow {
 public:
  using State = PairStateOf<Real>;

  // A state inside Gamma. On its boundary it may be about to leave: that is an event at time 0.
  EventFlow(const PairGeometry& geometry, const State& state);

  // Moves to the next event. Reflections from walls are resolved. At a ball-piston collision the
  // two are in contact, still approaching: ExchangeComponents() has to come before the next Step.
  // kEscape: the ball flies on without a wall ahead, which no orbit should do.
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
  int last_disc_ = kNoDisc;  // on which the ball is, if it is on one
  typename CellWalls<Real>::Encounter encounter_ = {};
  Real time_to_wall_ = 0;         // the ball's
  Real time_to_piston_wall_ = 0;  // the piston's
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_BILLIARD_EVENT_FLOW_H_
