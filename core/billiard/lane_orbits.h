// Orbits in vector lanes; see orbits.h.
#pragma once

#include <memory>

#include "core/billiard/orbits.h"

namespace ballpiston {

std::unique_ptr<OrbitRun> StartLaneOrbits(const PairGeometry& geometry, OrbitSource& source);
// With flights in single precision: faster, with the errors that single_precision.h states.
std::unique_ptr<OrbitRun> StartLaneOrbitsSingle(const PairGeometry& geometry, OrbitSource& source);

}  // namespace ballpiston
