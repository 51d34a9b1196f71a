// The naive method for ball and piston: a fixed time step, and a repair of each overlap. Programs
// that integrate forces work in this way. It is the baseline for the event-driven flows.
//
// Each step moves both along straight lines. Then
//   - a ball inside a disc is pushed out along the normal, and its velocity is reflected if it
//     heads inward;
//   - a piston beyond its wall is folded back, which is exact;
//   - a ball that has passed the piston collides with it, up to a step too late.
// On average a hit is half a step late. Therefore times have a bias of first order in the step,
// larger than the step divided by the mean flight. Contacts shorter than a step are missed.
// Properties, each with a test of its name: 1. EnergyStaysExact, to rounding.
// 2. TimeIsBiasedToFirstOrderInTheStep.
//
// One object is one orbit; not for sharing between threads.
#pragma once

#include <cstdint>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/fixed_step_ball.h"

namespace ballpiston {

// The events in the last of several time steps. There may be none.
struct FixedSteps {
  uint64_t steps = 0;
  bool ball_wall = false;
  bool piston_wall = false;
  bool ball_piston = false;  // they still approach: call ExchangeComponents() before the next step
  bool lost = false;         // the ball left the unit cell, or is wedged between two discs
};

class FixedStepFlow {
 public:
  // time_step > 0.
  FixedStepFlow(const PairGeometry& geometry, const PairState& state, double time_step);

  // Makes steps until a repair is needed, but at most `most` steps; `most` >= 1.
  FixedSteps Advance(uint64_t most);
  void ExchangeComponents();

  PairState state() const;

 private:
  uint64_t MoveFreely(uint64_t most);
  bool RepairPiston();

  double time_step_;
  double rho_squared_;
  double piston_left_;
  double piston_right_;

  FixedStepBall ball_;
  double piston_;
  double piston_velocity_;
};

}  // namespace ballpiston
