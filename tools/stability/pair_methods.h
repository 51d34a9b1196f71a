// The methods that run ball-piston pairs. Each method is one function.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

struct PairMethod {
  std::string name;
  double share;           // of a case's starts
  double smallest_delta;  // below this delta positions are too inexact for the checks
  bool promised;          // the method promises zeros everywhere

  // Each pair runs for `collisions` collisions of ball and piston.
  Failures (*run)(const PairGeometry& geometry, std::span<const PairState> starts,
                  uint64_t collisions);
};

const std::vector<PairMethod>& PairMethods();

}  // namespace ballpiston::stability
