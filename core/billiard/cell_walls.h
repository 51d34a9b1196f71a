// The four arcs around the ball's cell, and the ball's flight from arc to arc, in numbers of any
// precision. Part of EventFlow; event_flow.h describes the numerical stability.
//
// Real is a floating-point type with numeric_limits, sqrt and fabs. Immutable.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/billiard/exchange.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

inline constexpr int kNoDisc = -1;

template <typename Real>
class CellWalls {
 public:
  using Vector = Eigen::Matrix<Real, 2, 1>;

  explicit CellWalls(const PairGeometry& geometry)
      : rho_(static_cast<Real>(geometry.rho())),
        inverse_rho_(1 / rho_),
        centres_{Centre(0), Centre(1), Centre(2), Centre(3)} {}

  // The disc that a ball's ray hits: the distance along the ray, and the angle phi between the ray
  // and the normal at the hit, rho sin(phi) = c, rho cos(phi) = s. If the ray misses the disc,
  // `disc` is kNoDisc and the distance is infinite.
  struct Encounter {
    int disc = kNoDisc;
    Real distance = std::numeric_limits<Real>::infinity();
    Real sin_phi = 0;
    Real cos_phi = 0;
  };

  // The disc that a ball in the cell hits next. `last_disc`, on which the ball is, is excluded.
  Encounter Next(const Vector& position, const Vector& direction, int last_disc) const {
    // The ball is inside the unit cell, so it moves away from the centre in the quadrant behind it.
    const int behind = (direction.x() < 0 ? 1 : 0) | (direction.y() < 0 ? 2 : 0);
    const std::array<Encounter, 3> discs = {HitOf(behind ^ 1, position, direction, last_disc),
                                            HitOf(behind ^ 2, position, direction, last_disc),
                                            HitOf(behind ^ 3, position, direction, last_disc)};
    // The disc that is hit is practically random, so an index costs less than mispredicted
    // branches.
    const size_t beside = discs[1].distance < discs[0].distance;
    const size_t ahead = discs[2].distance < discs[beside].distance;
    return discs[std::max(beside, 2 * ahead)];
  }

  // Moves the ball to the wall and reflects it there. The impact parameter is constant along the
  // ray, and centre - hit = s u + c u_perp. The factor that keeps the normal's length at 1 is
  // computed from u, so it does not wait for the square root.
  void Reflect(const Encounter& hit, Vector& position, Vector& direction) const {
    const Real unit = OneOverLength(direction);
    const Vector normal =
        direction * (-unit * hit.cos_phi) + Perpendicular(direction) * (-unit * hit.sin_phi);
    position = centres_[static_cast<size_t>(hit.disc)] + normal * rho_;
    direction = normal * hit.cos_phi + Perpendicular(normal) * hit.sin_phi;
  }

 private:
  // Discs are numbered by the signs of their centres: bit 0 for x, bit 1 for y.
  static Vector Centre(int disc) {
    return {static_cast<Real>((disc & 1) != 0 ? 0.5 : -0.5),
            static_cast<Real>((disc & 2) != 0 ? 0.5 : -0.5)};
  }
  static Real Cross(const Vector& a, const Vector& b) { return a.x() * b.y() - a.y() * b.x(); }
  static Vector Perpendicular(const Vector& a) { return {-a.y(), a.x()}; }

  Encounter HitOf(int disc, const Vector& position, const Vector& direction, int last_disc) const {
    using std::sqrt;
    const Vector to_centre = centres_[static_cast<size_t>(disc)] - position;
    const Real foot = direction.dot(to_centre);
    const Real impact = Cross(direction, to_centre);
    const Real square = rho_ * rho_ - impact * impact;
    // & instead of &&, because && makes a branch for each condition, which is often mispredicted.
    const int hit = int{disc != last_disc} & int{foot > 0} & int{square > 0};
    const Real half_chord = sqrt(hit ? square : Real(0));
    const Real distance = std::max(foot - half_chord, Real(0));
    return {hit ? disc : kNoDisc, hit ? distance : std::numeric_limits<Real>::infinity(),
            impact * inverse_rho_, half_chord * inverse_rho_};
  }

  Real rho_;
  Real inverse_rho_;
  std::array<Vector, 4> centres_;
};

}  // namespace ballpiston
