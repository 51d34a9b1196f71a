// Tangent vectors of a periodic gas, followed through every event of the reference: how the
// difference of two neighbouring orbits grows (billiard/tangent_map.h derives the maps).
//
// All masses are 1, so a gas of f degrees of freedom is one point with f coordinates: f = 3 cells
// in a chain, and 4 cells in a lattice. A vector has 2 f components: x, y, vx, vy of each ball,
// then q, p of each piston, toward +x and +y. An event changes the components of one ball, one
// piston, or both. A body's components are moved, as the reference moves the body, only at its own
// events.
//
// The flow and the energy have the exponents 0, and the others come in pairs of opposite signs. So
// there are f - 1 exponents that are not negative. Vectors that start as velocities across the
// gas's velocity w stay across the flow and do not change the energy, so f - 1 of them measure
// these exponents. After some wall hits Gram and Schmidt's method makes the vectors orthonormal in
// their order, and the logarithms of the factors are added up.
//
// Properties, each with a test of its name: 1. NearbyGasesDivergeAsPredicted.
// 2. ExponentsOfAGasComeInPairs. Not thread-safe.
#pragma once

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
  using Vector = std::vector<double>;  // 2 f components

  // At least one vector; they must be linearly independent.
  GasTangents(const GasGeometry& geometry, const std::vector<Vector>& start);

  // The event of the gas, after it.
  void Follow(const GasEvent& event, const ReferenceGas& gas);

  // The logarithms of the factors by which the vectors have grown from the last call to `time`, at
  // or after the last event.
  std::vector<double> TakeGrowth(double time);

 private:
  // The component of all vectors.
  double* Row(size_t component) { return rows_.data() + component * count_; }
  size_t RowOfBall(int64_t ball) const { return 4 * static_cast<size_t>(ball); }
  size_t RowOfPiston(int64_t piston) const { return 4 * balls_ + 2 * static_cast<size_t>(piston); }

  void MoveBall(int64_t ball, double time);
  void MovePiston(int64_t piston, double time);
  void AddTimes(double time, size_t velocity, size_t position);
  void ReflectBall(int64_t ball, const GasBall& after);
  void ReflectPiston(int64_t piston);
  void Exchange(const GasEvent& event);
  void Orthonormalise(double time);

  size_t balls_, pistons_, count_;
  double rho_;
  std::vector<double> rows_;   // of 2 f components, each of `count_` vectors
  std::vector<double> times_;  // of balls and of pistons, to which their components have moved
  std::vector<double> growth_;
  std::vector<double> vector_, shares_;  // for Orthonormalise
  size_t hits_ = 0;                      // of walls by balls, since the vectors were orthonormal
};

// f - 1 velocities across the gas's velocity; a ball or a piston must move.
std::vector<GasTangents::Vector> VelocitiesAcross(const GasGeometry& geometry,
                                                  const GasState& state);

}  // namespace ballpiston
