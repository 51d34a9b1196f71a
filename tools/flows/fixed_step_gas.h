// The naive method for a gas: FixedStepFlow's rules (fixed_step_flow.h) for all balls and pistons.
//
// In each step the pistons move. A piston beyond its wall is folded back; at a thermal wall it gets
// a new speed. Then the balls move. A ball inside a disc is pushed out. A ball that has passed a
// piston exchanges energy with it, up to a step too late. A lost ball stops. Properties, each with
// a test of its name: 1. KeepsItsEnergy, to rounding.
// 2. ABallThatHasPassedAPistonExchanges, in each direction. 3. AllMethodsAgree, with thermal walls.
//
// One object is one gas. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_state.h"
#include "core/gas/thermal_walls.h"
#include "tools/flows/fixed_step_flow.h"

namespace ballpiston {

// NextTime, Step, BallAt and PistonAt are as in ReferenceGas.
class FixedStepGas {
 public:
  // time_step > 0.
  FixedStepGas(const GasGeometry& geometry, const GasState& start, ThermalWalls walls,
               double time_step = 1e-3);

  // Makes steps until there is an event, and returns the end time of this step. Infinity if no
  // event comes within 1000 units of time.
  double NextTime();
  // The next event. NextTime() must be finite.
  GasEvent Step();

  // At the end of the last step; `time` is ignored.
  GasBall BallAt(int64_t ball, double time) const;
  GasPiston PistonAt(int64_t piston, double /*time*/) const {
    return pistons_[static_cast<size_t>(piston)];
  }

 private:
  struct Ball {
    FixedStepBall moving;
    bool is_lost = false;
  };

  double Now() const { return static_cast<double>(steps_) * time_step_; }
  void Advance();
  void MovePiston(int64_t number);
  void MoveBall(int64_t number);
  void Collide(int64_t number, Direction direction);

  GasGeometry geometry_;
  ThermalWalls walls_;
  double time_step_;
  uint64_t steps_ = 0;
  std::vector<Ball> balls_;
  std::vector<GasPiston> pistons_;
  std::vector<GasEvent> events_;  // of the last step
  size_t told_ = 0;               // the number of these events that Step has returned
};

}  // namespace ballpiston
