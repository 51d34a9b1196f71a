// The billiard flow of a ball-piston pair, every event resolved, one at a time: the yardstick for
// every faster engine, and the source of traces.
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
// 3. ReversedVelocityRetracesOrbit, as far as rounding lets it (some 30 wall hits).
// 4. PistonStaysRightOfBall.
//
// Times are in cells per unit speed. One object is one orbit; not for sharing between threads.
#ifndef BALLPISTON_CORE_BILLIARD_REFERENCE_FLOW_H_
#define BALLPISTON_CORE_BILLIARD_REFERENCE_FLOW_H_

#include <Eigen/Core>
#include <array>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

enum class EventKind { kBallWall, kPistonWall, kBallPiston, kEscape };

struct Event {
  EventKind kind;
  double duration;  // time since the event before, >= 0
};

class ReferenceFlow {
 public:
  // A state inside Gamma. On its boundary it may be about to leave: that is an event at time 0.
  ReferenceFlow(const PairGeometry& geometry, const PairState& state);

  // Moves to the next event. Reflections from walls are resolved. At a ball-piston collision the
  // two are in contact, still approaching: ExchangeComponents() has to come before the next Step.
  // kEscape: the ball flies on without a wall ahead, which no orbit should do.
  Event Step();

  // Resolves the ball-piston collision that Step has just reported.
  void ExchangeComponents();

  const PairState& state() const { return state_; }

 private:
  static constexpr int kNoDisc = -1;

  // A disc that the ball's ray meets: distance along the ray, and the angle phi between the ray and
  // the normal there, rho sin(phi) = c, rho cos(phi) = s. kNoDisc, infinitely far, if it misses it.
  struct Encounter {
    int disc;
    double distance;
    double sin_phi;
    double cos_phi;
  };

  Encounter NextDisc() const;
  Encounter Meet(int disc) const;
  void AimBall();
  void TimePiston();
  void Advance(double duration);
  void ReflectBall();
  void ReflectPiston();

  double rho_;
  double inverse_rho_;
  double piston_left_;
  double piston_right_;
  std::array<Eigen::Vector2d, 4> centres_;

  PairState state_;
  int last_disc_ = kNoDisc;  // on which the ball is, if it is on one
  Encounter encounter_ = {};
  double time_to_wall_ = 0;         // the ball's
  double time_to_piston_wall_ = 0;  // the piston's
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_BILLIARD_REFERENCE_FLOW_H_
