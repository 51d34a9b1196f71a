// Orbits of many pairs by any method, from collision to collision (see billiard/orbits.h). An orbit
// that is lost, or whose time no longer advances, ends with an escape.
#pragma once

#include <cstdint>

#include "core/geometry/pair_geometry.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/method_comparison/method.h"

namespace ballpiston::method_comparison {

// Not for kClosedForm, kMarkov and kSpectrum, which have no such orbits. Starts and collisions are
// doubles; between them all numbers have the method's precision.
void RunMethodOrbits(const MethodVariant& variant, const PairGeometry& geometry, uint64_t orbits,
                     NumberedOrbits& source);

}  // namespace ballpiston::method_comparison
