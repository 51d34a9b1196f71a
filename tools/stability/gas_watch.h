// Checks gases: after each event if the method reports all events, else through their meters, by
// the exchanges of a short run, and by the energies at the end of any run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_run.h"
#include "core/gas/gas_state.h"
#include "core/gas/reference_gas.h"
#include "core/gas/thermal_walls.h"
#include "tools/stability/ball_watch.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

// Checks every event of one gas.
//
// Between two of its events a body moves in a straight line. The watch moves every body from its
// last event to its next event and checks there that the ball is not beyond one of its pistons, and
// that the piston is not beyond the ends of its path. At a contact this check covers the whole time
// between the two events, because the gap between a ball and a piston changes linearly.
class GasWatch {
 public:
  // `walls` says which pistons get energy from outside.
  GasWatch(const GasGeometry& geometry, const GasState& start, const ThermalWalls& walls,
           double epsilon);

  // Checks an event, with its ball and its piston after the event; a body without part in the event
  // is ignored. Returns false if the gas has failed and must not be continued.
  bool See(const GasEvent& event, const GasBall& ball, const GasPiston& piston, Failures& failures);

  // |dE/E| of the whole gas since the start, without the energy from thermal walls.
  double EnergyError() const;

 private:
  struct Ball {
    GasBall state;
    Standstill standstill;
    double since = 0;
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
  std::vector<Ball> balls_;
  std::vector<Piston> pistons_;
  double start_energy_ = 0;
  double given_ = 0;  // the energy from thermal walls
  double last_ = 0;   // the time of the latest event
};

// The reading of a gas's meter at one time.
struct GasReading {
  std::vector<double> energies;  // by body
  uint64_t exchanges = 0;

  double Total() const;
};

GasReading ReadingOf(const GasMeter& meter);

// Compares the reading of a replica at `time` with the readings of the reference gas, from the same
// start and from neighbouring starts. Rounding errors grow with every hit: therefore `time` is the
// duration of a few flights. A difference counts if the engine differs from all neighbours by more
// than they differ from each other. It counts as missed if the engine had fewer exchanges than the
// reference, else as a phantom.
Failures LookBack(const GasGeometry& geometry, const GasStart& replica, double time,
                  const GasReading& reading);

// Checks a replica that started with the energy `start`. Counts escapes, also if an energy is not a
// number, and, without thermal walls, the error of the energy.
Failures LookAtEnergies(const GasGeometry& geometry, const GasMeter& meter, double start);

}  // namespace ballpiston::stability
