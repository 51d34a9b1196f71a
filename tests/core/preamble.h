// The headers and the geometries that most tests of the core need. A test includes this file after
// the header that it tests. Parameters of geometries must be valid.
#pragma once

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "core/sampling/counter_random.h"
#include "core/statistics/moments.h"
#include "tests/support/preamble.h"
#include "tools/flows/paper.h"

namespace ballpiston {

inline PairGeometry GeometryOf(double rho, double delta) {
  return PairGeometry::Create(rho, delta).value();
}

inline PairGeometry PaperGeometry(double delta) { return GeometryOf(kPaperRho, delta); }

// At the gas bound. Collisions are frequent here: one in 15 units of time.
inline const PairGeometry kPaperPair = PaperGeometry(0.2);

// delta is `share` times its bound.
inline PairGeometry GeometryAtShare(double rho, double share) {
  return GeometryOf(rho, share * PairDeltaBound(rho));
}

}  // namespace ballpiston
