// Looks at a gas after each of its events, as long as a method tells them all.
//
// Between two events of its own a body moves straight. So the watch carries every body from its
// last event to the next one by itself, and looks there: whether the ball is beyond one of its
// pistons, and whether the piston is beyond the ends of its way. At a contact both hold for the
// whole time in between, because the gap of a ball and a piston changes evenly.
#ifndef BALLPISTON_TOOLS_STABILITY_GAS_WATCH_H_
#define BALLPISTON_TOOLS_STABILITY_GAS_WATCH_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/gas/reference_gas.h"
#include "core/gas/thermal_walls.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

class GasWatch {
 public:
  // `walls` says which pistons get energy from outside.
  GasWatch(const GasGeometry& geometry, const GasState& start, const ThermalWalls& walls,
           double epsilon);

  // An event, and its ball and its piston after it; a body that the event does not have is ignored.
  // False when the gas has come to a bad end.
  bool See(const GasEvent& event, const GasBall& ball, const GasPiston& piston, Failures& failures);

  // |dE/E| of the whole gas since the start, without what thermal walls have given.
  double EnergyError() const;

 private:
  struct Ball {
    GasBall state;
    double since = 0;
    uint64_t standstill = 0;
  };
  struct Piston {
    GasPiston state;
    double since = 0;
  };

  static size_t Index(int64_t i) { return static_cast<size_t>(i); }

  void LookAtWay(const GasEvent& event, Failures& failures) const;
  void LookForMissed(int64_t ball, double time, Failures& failures) const;
  bool IsBeyond(const Ball& ball, Direction direction, const Piston& piston, double time) const;
  bool SeeBall(const GasEvent& event, const GasBall& after, Failures& failures);
  void SeePiston(const GasEvent& event, const GasPiston& after);
  void SeeExchanged(const GasEvent& event, Failures& failures) const;

  GasGeometry geometry_;
  ThermalWalls walls_;
  BallWatch look_;
  double epsilon_;
  double short_;
  uint64_t longest_standstill_;
  std::vector<Ball> balls_;
  std::vector<Piston> pistons_;
  double start_energy_ = 0;
  double given_ = 0;  // by thermal walls
  double last_ = 0;   // the latest event
};

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_GAS_WATCH_H_
