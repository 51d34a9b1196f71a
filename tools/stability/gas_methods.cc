#include "tools/stability/gas_methods.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/gas/gas_run.h"
#include "core/gas/hit_rates.h"
#include "core/gas/reference_gas.h"
#include "tools/stability/fixed_step_gas_events.h"
#include "tools/stability/gas_look_back.h"
#include "tools/stability/gas_watch.h"
#include "tools/stability/metered_gases.h"
#include "tools/stability/own_process.h"
#include "tools/stability/textbook_gas.h"

namespace ballpiston::stability {
namespace {

template <typename Gas>
void RunGasWatched(const GasGeometry& geometry, const GasReplica& replica, double end,
                   Failures& failures) {
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
}

template <typename Gas>
Failures RunGasByEvents(const GasGeometry& geometry, std::span<const GasReplica> replicas,
                        double flights) {
  Failures failures;
  const double end = flights * MeanFlight(geometry.pair());
  for (const GasReplica& replica : replicas) RunGasWatched<Gas>(geometry, replica, end, failures);
  return failures;
}

Failures AtEnd(const GasGeometry& geometry, const MeteredGases& gases) {
  Failures failures;
  for (size_t i = 0; i < gases.size(); ++i) {
    failures.Merge(LookAtEnergies(geometry, gases.meter(i), gases.EnergyAtStart(i)));
  }
  return failures;
}

Failures RunLanesToTheEnd(const GasGeometry& geometry, std::span<const GasReplica> replicas,
                          double flights) {
  constexpr double kFewFlights = 10;
  const double flight = MeanFlight(geometry.pair());
  const double soon = std::min(kFewFlights, flights) * flight;
  MeteredGases gases(GasEngine::kLanes, geometry, replicas);
  gases.AdvanceTo(soon);
  Failures failures;
  for (size_t i = 0; i < replicas.size(); ++i) {
    failures.Merge(LookBack(geometry, replicas[i], soon, ReadingOf(gases.meter(i))));
  }
  gases.AdvanceTo(flights * flight);
  failures.Merge(AtEnd(geometry, gases));
  return failures;
}

// The lanes report nothing before the requested time. Replicas that never reach this time count as
// one loop.
Failures RunLanes(const GasGeometry& geometry, std::span<const GasReplica> replicas,
                  double flights) {
  // Seconds. Usually a tenth of a second is enough; a run on a slow machine must not count as a
  // loop.
  constexpr unsigned kPatience = 60;
  const auto run = [&] { return RunLanesToTheEnd(geometry, replicas, flights); };
  return InOwnProcess(run, kPatience).value_or(Failures{.orbits = replicas.size(), .loops = 1});
}

Failures RunJumps(const GasGeometry& geometry, std::span<const GasReplica> replicas,
                  double flights) {
  MeteredGases gases(GasEngine::kJumps, geometry, replicas);
  gases.AdvanceTo(flights * MeanFlight(geometry.pair()));
  return AtEnd(geometry, gases);
}

}  // namespace

const std::vector<GasMethod>& GasMethods() {
  static const auto* const methods = new std::vector<GasMethod>{
      {"lanes", 1, true, RunLanes},
      {"reference", 1, true, RunGasByEvents<ReferenceGas>},
      {"jump process", 1, true, RunJumps},
      {"nearest root", 0.02, false, RunGasByEvents<TextbookGas<TextbookRule::kPositiveRoot>>},
      {"approaching disc", 0.02, false, RunGasByEvents<TextbookGas<TextbookRule::kApproaching>>},
      {"fixed steps of 1e-3", 0.01, false, RunGasByEvents<FixedStepGasEvents>},
  };
  return *methods;
}

}  // namespace ballpiston::stability
