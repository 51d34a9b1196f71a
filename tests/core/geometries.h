// Geometries for tests. They have to be valid.
#ifndef BALLPISTON_TESTS_CORE_GEOMETRIES_H_
#define BALLPISTON_TESTS_CORE_GEOMETRIES_H_

#include "core/geometry/pair_geometry.h"
#include "core/geometry/paper.h"

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

#endif  // BALLPISTON_TESTS_CORE_GEOMETRIES_H_
