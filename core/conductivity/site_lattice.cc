#include "core/conductivity/site_lattice.h"

namespace ballpiston {

SiteLattice BallPistonChain() {
  return {.dimensions = {2, 1}, .period = 2, .has_rows = false, .contacts = {{{0, 0}, {1, 0}, 2}}};
}

SiteLattice EqualSitesChain(int dimension) {
  return {.dimensions = {dimension, dimension},
          .period = 1,
          .has_rows = false,
          .contacts = {{{0, 0}, {1, 0}, 1}}};
}

SiteLattice BallPistonLattice() {
  return {.dimensions = {2, 1},
          .period = 2,
          .has_rows = true,
          .contacts = {{{0, 0}, {1, 0}, 2}, {{0, 0}, {0, 1}, 2}}};
}

}  // namespace ballpiston
