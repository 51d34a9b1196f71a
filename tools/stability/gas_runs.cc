#include "tools/stability/gas_runs.h"

#include <cstddef>

#include "server/processor_time.h"
#include "tools/flows/metered_gases.h"
#include "tools/stability/gas_watch.h"

namespace ballpiston::stability {
namespace {

MeteredGases Started(GasEngine engine, const GasGeometry& geometry,
                     std::span<const GasStart> replicas) {
  return {engine, geometry, {replicas.begin(), replicas.end()}};
}

Failures AtEnd(const GasGeometry& geometry, std::span<const GasStart> replicas,
               MeteredGases& gases) {
  Failures failures;
  for (size_t i = 0; i < replicas.size(); ++i) {
    const double start = GasMeter(geometry, replicas[i].state).TotalEnergy();
    failures.Merge(LookAtEnergies(geometry, gases.meters()[i], start));
  }
  return failures;
}

// Returns false if this takes more processor time than `patience`.
bool AdvanceTo(double time, MeteredGases& gases, double patience) {
  const double end = server::ThreadSeconds() + patience;
  while (!gases.AdvanceToward(time)) {
    if (server::ThreadSeconds() > end) return false;
  }
  return true;
}

}  // namespace

Failures RunLaneGases(const GasGeometry& geometry, std::span<const GasStart> replicas,
                      uint64_t flights, double patience) {
  constexpr uint64_t kFewFlights = 10;
  const Failures endless = {.orbits = replicas.size(), .loops = 1};
  const double flight = MeanFlight(geometry.pair());
  const double soon = static_cast<double>(std::min(kFewFlights, flights)) * flight;
  MeteredGases gases = Started(GasEngine::kLanes, geometry, replicas);
  if (!AdvanceTo(soon, gases, patience)) return endless;
  Failures failures;
  for (size_t i = 0; i < replicas.size(); ++i) {
    failures.Merge(LookBack(geometry, replicas[i], soon, ReadingOf(gases.meters()[i])));
  }
  if (!AdvanceTo(static_cast<double>(flights) * flight, gases, patience)) return endless;
  failures.Merge(AtEnd(geometry, replicas, gases));
  return failures;
}

Failures RunJumpGases(const GasGeometry& geometry, std::span<const GasStart> replicas,
                      uint64_t flights) {
  MeteredGases gases = Started(GasEngine::kJumps, geometry, replicas);
  gases.AdvanceTo(static_cast<double>(flights) * MeanFlight(geometry.pair()));
  return AtEnd(geometry, replicas, gases);
}

}  // namespace ballpiston::stability
