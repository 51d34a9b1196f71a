// The infinite chains and the lattice on which the jump process moves energy, as a graph of sites.
//
// Sites have whole coordinates, and neighbours have distance 1. A ball has even coordinates; a
// piston has one odd coordinate. Unlike in the core, a cell here has length 2. In a chain of equal
// sites a cell has length 1.
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "tools/conductivity/contact_matrix.h"

namespace ballpiston {

struct Site {
  int16_t x = 0;
  int16_t y = 0;

  friend auto operator<=>(const Site&, const Site&) = default;
};

// A contact of one cell. All other contacts follow by translation and by reflection of x and of y.
struct SiteContact {
  Site a;
  Site b;
  int copies;  // in one cell, by reflections

  // The change of the field sum(x e) if an energy 1 goes from b to a.
  int field() const { return a.x - b.x; }
};

struct SiteLattice {
  SiteDimensions dimensions;  // of the velocities of a contact's two sites
  int period;                 // length of a cell
  bool has_rows;              // extends along y also
  std::vector<SiteContact> contacts;

  bool HasSite(Site site) const { return !has_rows || site.x % 2 == 0 || site.y % 2 == 0; }
};

// Ball, piston, ball, piston, ...
inline SiteLattice BallPistonChain() { return {{2, 1}, 2, false, {{{0, 0}, {1, 0}, 2}}}; }

// Equal sites of d velocity components: 2 is the model of discs, 3 that of spheres.
inline SiteLattice EqualSitesChain(int d) { return {{d, d}, 1, false, {{{0, 0}, {1, 0}, 1}}}; }

// A ball in each cell and a piston on each edge of the square lattice.
inline SiteLattice BallPistonLattice() {
  return {{2, 1}, 2, true, {{{0, 0}, {1, 0}, 2}, {{0, 0}, {0, 1}, 2}}};
}

}  // namespace ballpiston
