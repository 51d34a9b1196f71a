// Tangent vectors of a gas without reservoirs, or of a pair, followed through every event of the
// reference: how the difference of two neighbouring orbits grows (billiard/tangent_map.h derives
// the maps).
//
// All masses are 1, so a gas of f degrees of freedom is one point with f coordinates: f = 3 cells
// in a chain, and 4 cells in a lattice. A vector has a position and a velocity for each degree of
// freedom: of a ball across its path (a, A) and along it (l, L), and of a piston (q, p). In a
// flight each position grows by the time times its velocity. A wall hit of a ball changes its signs
// across the path, and adds 2 v a/(rho cos(phi)) to A; one of a piston changes its signs. An
// exchange exchanges the components along the piston's axis. Each event changes only the bodies
// that take part, and they are moved, as the reference moves them, only at their own events.
//
// The flow and the energy have the exponents 0, and the others come in pairs of opposite signs. So
// f - 1 exponents are positive. Vectors that start without positions, with velocities orthogonal to
// the gas's velocity w, stay orthogonal to the flow and do not change the energy, so f - 1 of them
// measure these exponents. After some wall hits Gram and Schmidt's method makes the vectors
// orthonormal in their order, and the logarithms of the factors are added up.
//
// Where exchanges are rare, each of the first vectors soon has the direction of one ball. Its
// components at the other balls decay, to exp(-1000) and less. They must keep their relative
// precision, because another ball may become the faster one. Therefore a number is m 2^power, with
// a power for each degree of freedom of a vector; and the components across a path, which grow
// fast, are separate from those along it, whose rounding would hide them. (With Cartesian
// components in plain doubles the first exponent of four cells was 2 % too small at delta = 0.03
// and 10 % at 0.02; the sum was right.)
//
// Waits are differences of times since the start, so they have an error of 1e-9 at a time of 1e7.
//
// Properties, each with a test of its name: 1. NearbyGasesDivergeAsPredicted.
// 2. SmallComponentsAreKept. Not thread-safe.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/gas/reference_gas.h"

namespace ballpiston {

// Half the dimension of the phase space.
inline size_t DegreesOfFreedom(const GasGeometry& geometry) {
  return static_cast<size_t>(2 * geometry.balls() + geometry.pistons());
}

class GasTangents {
 public:
  // 2 f components: x, y, vx, vy of each ball, then q, p of each piston, toward +x and +y.
  using Vector = std::vector<double>;

  // `vectors` at the gas's start: at least one, linearly independent.
  GasTangents(double rho, const GasState& start, const std::vector<Vector>& vectors);

  // An event, and the state after it of the ball that takes part.
  void Follow(const GasEvent& event, const GasBall& after);
  // The gas's last event.
  void Follow(const GasEvent& event, const ReferenceGas& gas) {
    Follow(event, event.ball >= 0 ? gas.BallAt(event.ball, event.time) : GasBall());
  }

  // The logarithms of the factors by which the vectors have grown from the last call to `time`, at
  // or after the last event.
  std::vector<double> TakeGrowth(double time);

 private:
  // A degree of freedom: a position and a velocity of each vector, both times 2^power.
  struct Freedom {
    std::vector<double> position, velocity, power;
    double time = 0;  // to which it has moved

    explicit Freedom(size_t vectors) : position(vectors), velocity(vectors), power(vectors) {}
    void MoveTo(double now);
    void ChangeSigns();
    void SetPowers();
  };

  Freedom& Across(int64_t ball) { return freedoms_[2 * static_cast<size_t>(ball)]; }
  Freedom& Along(int64_t ball) { return freedoms_[2 * static_cast<size_t>(ball) + 1]; }
  Freedom& OfPiston(int64_t piston) {
    return freedoms_[2 * directions_.size() + static_cast<size_t>(piston)];
  }

  void Move(const GasEvent& event);
  void ReflectBall(int64_t ball, const GasBall& after);
  void Exchange(const GasEvent& event, const GasBall& after);
  void Orthonormalise(double time);
  void MultiplyByLater(size_t k);
  void SubtractFromLater(size_t k);
  void Normalise(size_t k);

  double rho_;
  std::vector<Freedom> freedoms_;            // of the balls, across and along, then of the pistons
  std::vector<Eigen::Vector2d> directions_;  // of the balls
  std::vector<double> growth_;
  // The scalar products of one vector with all later ones: m 2^power.
  std::vector<double> products_, powers_;
  size_t hits_ = 0;  // of walls by balls, since the vectors were orthonormal
};

// f - 1 velocities across the gas's velocity; a ball or a piston must move.
std::vector<GasTangents::Vector> VelocitiesAcross(const GasState& state);

}  // namespace ballpiston
