// The methods that run ball-piston pairs, behind one function each.
#ifndef BALLPISTON_TOOLS_STABILITY_PAIR_METHODS_H_
#define BALLPISTON_TOOLS_STABILITY_PAIR_METHODS_H_

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
  double smallest_delta;  // below, positions are not known well enough to ask
  bool promised;          // to show zeros everywhere

  // Each pair runs for that many collisions of ball and piston.
  Failures (*run)(const PairGeometry& geometry, std::span<const PairState> starts,
                  uint64_t collisions);
};

const std::vector<PairMethod>& PairMethods();

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_PAIR_METHODS_H_
