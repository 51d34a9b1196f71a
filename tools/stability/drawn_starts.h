// Starts of a case. The i-th start does not depend on earlier draws.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "core/sampling/counter_random.h"

namespace ballpiston::stability {

using DrawStart = PairState(const PairGeometry& geometry, CounterRandom& random);

// The starts with the numbers first ... first + count - 1.
inline std::vector<PairState> DrawnStarts(DrawStart& draw, const PairGeometry& geometry,
                                          uint64_t seed, uint64_t first, uint64_t count) {
  std::vector<PairState> starts;
  starts.reserve(count);
  for (uint64_t i = first; i < first + count; ++i) {
    CounterRandom random(seed, 0, i);
    starts.push_back(draw(geometry, random));
  }
  return starts;
}

}  // namespace ballpiston::stability
