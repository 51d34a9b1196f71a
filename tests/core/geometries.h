// Geometries for tests. Their parameters must be valid.
#pragma once

#include <vector>

#include "core/geometry/pair_geometry.h"
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

// From cusps over the paper's cell to a nearly vanished one, from the deepest piston to a rare one.
inline std::vector<PairGeometry> GeometriesOfFlows() {
  std::vector<PairGeometry> geometries;
  for (const double rho : {0.5 + 1e-9, 0.5 + 1e-4, 0.501, kPaperRho, 0.6, 0.7, 0.7071}) {
    for (const double share : {1.0, 0.3, 1e-2, 1e-5}) {
      geometries.push_back(GeometryAtShare(rho, share));
    }
  }
  return geometries;
}

}  // namespace ballpiston
