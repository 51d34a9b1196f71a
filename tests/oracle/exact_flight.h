// One flight of the ball alone from disc to disc, in numbers of any precision, by the definition:
// the nearest of all discs that the ray hits. Faster flights are compared with it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>

#include "core/geometry/pair_geometry.h"

namespace ballpiston::oracle {

// Discs are numbered by the signs of their centres: bit 0 for x, bit 1 for y.
inline int DiscOfQuadrant(const Eigen::Vector2d& position) {
  return (position.x() > 0 ? 1 : 0) | (position.y() > 0 ? 2 : 0);
}

inline Eigen::Vector2d DiscCentre(int disc) {
  return {(disc & 1) != 0 ? 0.5 : -0.5, (disc & 2) != 0 ? 0.5 : -0.5};
}

template <typename Real>
struct ExactFlight {
  // The relation of a ray to a disc.
  struct Disc {
    Real impact;  // direction x (centre - ball); the ray crosses the disc if below rho
    Real length;  // to the point where the ray enters the disc; infinity if there is no such point
    Real cosine;  // of the angle to the normal there
  };

  // The ball flies away from disc `from`, or from none if that is -1; a direction of any length.
  ExactFlight(const PairGeometry& geometry, const Eigen::Vector2d& position,
              const Eigen::Vector2d& direction, int from) {
    using std::sqrt;
    const Real x = direction.x(), y = direction.y(), norm = sqrt(x * x + y * y);
    for (int i = 0; i < 4; ++i) {
      const Real dx = Real(DiscCentre(i).x()) - Real(position.x());
      const Real dy = Real(DiscCentre(i).y()) - Real(position.y());
      const Real foot = (x * dx + y * dy) / norm, impact = (x * dy - y * dx) / norm;
      const Real rho = geometry.rho(), square = (rho - impact) * (rho + impact);
      const bool hit = i != from && foot > 0 && square > 0;
      const Real root = hit ? Real(sqrt(square)) : Real(0);
      discs[static_cast<size_t>(i)] = {
          impact, hit ? foot - root : std::numeric_limits<Real>::infinity(), root / rho};
    }
    for (int i = 1; i < 4; ++i) {
      if (Of(i).length < Of(first).length) first = i;
    }
  }

  const Disc& Of(int disc) const { return discs[static_cast<size_t>(disc)]; }
  const Disc& First() const { return Of(first); }

  std::array<Disc, 4> discs;
  int first = 0;  // the disc that is hit
};

}  // namespace ballpiston::oracle
