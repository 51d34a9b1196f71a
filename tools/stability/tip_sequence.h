// The largest number of successive hits in a tip. It distinguishes a true cusp sequence from an
// orbit that stands still.
//
// Two discs meet at a tip at angles +-theta to the axis, tan(theta) = lambda. Between straight
// walls at that angle the orbit unfolds to a straight line, which crosses at most pi/(2 theta) of
// their images. Between the discs there are no more hits, because the discs open wider than their
// tangents. Flights much shorter than the cell are flights between two neighbouring discs near
// their tip. A longer sequence of such flights is not an orbit: it repeats its state, or rounding
// has moved it out of the cell.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/geometry/pair_geometry.h"

namespace ballpiston::stability {

// 5 at the paper's radius, 800 at rho - 1/2 = 1e-6, 800,000 at 1e-12; rounding may add a few.
inline uint64_t LongestTipSequence(const PairGeometry& geometry) {
  return static_cast<uint64_t>(std::numbers::pi / (2 * std::atan(geometry.lambda()))) + 8;
}

// The largest number of successive events without time between them. In a corner of walls and
// piston there are a few hits. If the piston presses the ball into a tip, there is a tip sequence
// between any two of these hits.
inline uint64_t LongestStandstill(const PairGeometry& geometry) {
  return 64 + 4 * LongestTipSequence(geometry);
}

}  // namespace ballpiston::stability
