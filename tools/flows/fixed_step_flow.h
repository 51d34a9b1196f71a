// The naive way to move ball and piston: by a fixed time step, repairing what penetrated. What a
// program does that knows forces but no events; the baseline that the event-driven flows are
// compared with.
//
// Each step moves both along straight lines, then
//   - a ball inside a disc is pushed out along the normal, and its velocity reflected if it heads
//     inward;
//   - a piston beyond its wall is folded back, which is exact;
//   - a ball that has passed the piston is a collision, found up to a step too late.
// A hit is on average half a step late, so times are biased to first order in the step, by more
// than the step over the mean flight; contacts shorter than a step are missed.
// Properties, each with a test of its name: 1. EnergyStaysExact, to rounding.
// 2. TimeIsBiasedToFirstOrderInTheStep.
//
// One object is one orbit; not for sharing between threads.
#ifndef BALLPISTON_TOOLS_FLOWS_FIXED_STEP_FLOW_H_
#define BALLPISTON_TOOLS_FLOWS_FIXED_STEP_FLOW_H_

#include <cstdint>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/flows/fixed_step_ball.h"

namespace ballpiston {

// What happened in the last of some time steps; nothing at all may have.
struct FixedSteps {
  uint64_t steps = 0;
  bool ball_wall = false;
  bool piston_wall = false;
  bool ball_piston = false;  // still approaching: ExchangeComponents() before the next step
  bool lost = false;         // the ball left the unit cell, or is wedged between two discs
};

class FixedStepFlow {
 public:
  // time_step > 0.
  FixedStepFlow(const PairGeometry& geometry, const PairState& state, double time_step);

  // Makes steps until there is something to repair, but not more than `most`, at least 1.
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

#endif  // BALLPISTON_TOOLS_FLOWS_FIXED_STEP_FLOW_H_
