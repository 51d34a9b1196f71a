// RunOrbits in vector lanes; see orbits.h.
#ifndef BALLPISTON_CORE_BILLIARD_LANE_ORBITS_H_
#define BALLPISTON_CORE_BILLIARD_LANE_ORBITS_H_

#include "core/billiard/orbits.h"

namespace ballpiston {

bool RunLaneOrbits(const PairGeometry& geometry, uint64_t orbits, OrbitSource& source,
                   const std::stop_token& stop);
// The flights in single precision: quicker, and wrong by what `make stability` shows.
bool RunLaneOrbitsSingle(const PairGeometry& geometry, uint64_t orbits, OrbitSource& source,
                         const std::stop_token& stop);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_BILLIARD_LANE_ORBITS_H_
