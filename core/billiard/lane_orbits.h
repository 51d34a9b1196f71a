// Orbits in vector lanes; see orbits.h.
#pragma once

#include <memory>

#include "core/billiard/orbits.h"

namespace ballpiston {

std::unique_ptr<EngineRun> StartLaneOrbits(const PairGeometry& geometry, OrbitSource& source);
// With flights in single precision: faster, with the errors that single_precision.h states.
std::unique_ptr<EngineRun> StartLaneOrbitsSingle(const PairGeometry& geometry, OrbitSource& source);

}  // namespace ballpiston
