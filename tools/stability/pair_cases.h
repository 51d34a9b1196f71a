// The situations with a piston in which methods fail, and the failures of each method there.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "core/sampling/counter_random.h"
#include "tools/stability/failures.h"
#include "tools/stability/pair_methods.h"

namespace ballpiston::stability {

struct PairCase {
  std::string name;
  std::vector<PairGeometry> geometries;
  PairState (*start)(const PairGeometry& geometry, CounterRandom& random);
  uint64_t starts;      // for each geometry, in the full table
  uint64_t collisions;  // per start
};

const std::vector<PairCase>& PairCases();

Failures RunCase(const PairCase& pair_case, const PairMethod& method, double effort);

}  // namespace ballpiston::stability
