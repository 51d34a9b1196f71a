// Orbits of many pairs by any of the methods, from collision to collision; see billiard/orbits.h.
// An orbit that is lost, or that no longer gets ahead in time, ends with an escape.
#ifndef BALLPISTON_CORE_METHOD_COMPARISON_METHOD_ORBITS_H_
#define BALLPISTON_CORE_METHOD_COMPARISON_METHOD_ORBITS_H_

#include <cstdint>
#include <stop_token>

#include "core/billiard/orbits.h"
#include "core/geometry/pair_geometry.h"
#include "core/method_comparison/method.h"

namespace ballpiston {

// Not for kClosedForm, kMarkov and kSpectrum, which have no such orbits. Starts and collisions pass
// as doubles; in between all numbers are the method's. False if `stop` came before the end.
bool RunMethodOrbits(const MethodVariant& variant, const PairGeometry& geometry, uint64_t orbits,
                     OrbitSource& source, const std::stop_token& stop);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_METHOD_COMPARISON_METHOD_ORBITS_H_
