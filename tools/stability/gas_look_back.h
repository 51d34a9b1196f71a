// Checks gases of an engine that reports only energies, through their meters: the exchanges of a
// short run, and the energies at the end of any run.
#pragma once

#include <cstdint>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_run.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

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
