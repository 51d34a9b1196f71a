// Checks gases: after each event if the method reports all events, else through their meters, by
// the exchanges of a short run, and by the energies at the end of any run.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/closed_form/pair_measures.h"
#include "core/gas/gas_exchange_rate.h"
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

  // dE/E of the whole gas since the start, without the energy from thermal walls.
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

// Compares the meter of a replica at `time` with the meters of the reference gas, from the same
// start and from neighbouring starts. Rounding errors grow with every hit: therefore `time` is the
// duration of a few flights. A difference counts if the engine differs from all neighbours by more
// than they differ from each other. It counts as missed if the engine had fewer exchanges than the
// reference, else as a phantom.
Failures LookBack(const GasGeometry& geometry, const GasStart& replica, double time,
                  const GasMeter& meter);

// Checks a replica that started with the energy `start`. Counts escapes, also if an energy is not a
// number, and, without thermal walls, the error of the energy.
Failures LookAtEnergies(const GasGeometry& geometry, const GasMeter& meter, double start);

// ---- checked runs, for the time of so many flights of a ball of speed 1 ----

// These engines report nothing before the requested time. Gases that are not there after so many
// calls, each of some 2 ms, count as one loop; usually 2 s are enough for kTogether gases.
inline constexpr uint64_t kMostCalls = 300'000;

template <GasEngine engine, uint64_t most_calls = kMostCalls>
Failures RunGasesByMeters(const GasGeometry& geometry, std::span<const GasStart> replicas,
                          uint64_t flights) {
  constexpr uint64_t kFewFlights = 10;
  const double flight = MeanFlight(geometry.pair());
  const auto gases = StartGases(engine, geometry, GasExchangeRate(geometry, 1),
                                {replicas.begin(), replicas.end()});
  uint64_t calls = 0;
  const auto arrives = [&](double time) {
    while (calls++ < most_calls) {
      if (gases->AdvanceToward(time)) return true;
    }
    return false;
  };
  const Failures endless = {.orbits = replicas.size(), .loops = 1};
  Failures failures;
  if (engine == GasEngine::kLanes) {
    const double soon = static_cast<double>(std::min(kFewFlights, flights)) * flight;
    if (!arrives(soon)) return endless;
    for (size_t i = 0; i < replicas.size(); ++i) {
      failures.Merge(LookBack(geometry, replicas[i], soon, gases->meters()[i]));
    }
  }
  if (!arrives(static_cast<double>(flights) * flight)) return endless;
  for (size_t i = 0; i < replicas.size(); ++i) {
    const double start = GasMeter(geometry, replicas[i].state).TotalEnergy();
    failures.Merge(LookAtEnergies(geometry, gases->meters()[i], start));
  }
  return failures;
}

template <typename Gas>
void RunGas(const GasGeometry& geometry, const GasStart& replica, double end, Failures& failures) {
  // A gas without a loop has far fewer events.
  constexpr uint64_t kMostEvents = 10'000'000;
  Gas gas(geometry, replica.state, replica.walls);
  GasWatch watch(geometry, replica.state, replica.walls, std::numeric_limits<double>::epsilon());
  ++failures.orbits;
  uint64_t events = 0;
  bool goes_on = true;
  for (; goes_on && events < kMostEvents && gas.NextTime() <= end; ++events) {
    const GasEvent event = gas.Step();
    goes_on = watch.See(event, gas.BallAt(std::max<int64_t>(event.ball, 0), event.time),
                        gas.PistonAt(std::max<int64_t>(event.piston, 0), event.time), failures);
  }
  failures.loops += events == kMostEvents;
  failures.SeeEnergy(watch.EnergyError());
  if (goes_on) failures.gain.Add(watch.EnergyError());
}

template <typename Gas>
Failures RunGasesByEvents(const GasGeometry& geometry, std::span<const GasStart> replicas,
                          uint64_t flights) {
  Failures failures;
  const double end = static_cast<double>(flights) * MeanFlight(geometry.pair());
  for (const GasStart& replica : replicas) RunGas<Gas>(geometry, replica, end, failures);
  return failures;
}

}  // namespace ballpiston::stability
