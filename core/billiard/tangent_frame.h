// Six tangent vectors, followed through every event of an orbit of the reference (tangent_map.h has
// the maps). They measure all six exponents, and are the yardstick of tangent_plane.h.
//
// The vectors start as an orthonormal basis of
//   two velocities across w, the flow (w, 0), the energy (0, w), two positions across w,
// in this order. Each event maps all six. After some wall hits, and after each collision, Gram and
// Schmidt's method makes them orthonormal in their order, and the logarithms of the factors are
// added up. In a long orbit they are the exponents times the time, in descending order. The third,
// the fourth and the sum of all six are 0 in exact arithmetic for any orbit, because the flow
// and the energy are the third and the fourth vector: they show errors of the maps and of rounding.
//
// Properties, each with a test of its name: 1. EveryEngineHasTheExponentsOfAnotherProgram.
// 2. ExponentsComeInPairs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/billiard/orbits.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

class TangentFrame {
 public:
  static constexpr size_t kExponents = 6;

  TangentFrame() = default;  // of no orbit
  // Requires a pair with the energy 1/2.
  TangentFrame(const PairGeometry& geometry, const PairState& start);

  // Every event, with the state after it; then, at a collision, the exchange.
  void Follow(const Event& event, const PairState& after);
  void Collide(const Collision&);

  // The logarithms of the factors by which the vectors have grown since the last call.
  std::array<double, kExponents> TakeGrowth();

 private:
  // The components x, y, q of dr, and then those of dw.
  using Tangent = std::array<double, 6>;

  void ReflectBall(const PairState& after);
  void ReflectPiston();
  void Orthonormalise();

  std::array<Tangent, kExponents> tangents_ = {};
  std::array<double, kExponents> growth_ = {};
  double rho_ = 0;
  uint64_t hits_ = 0;  // of the ball and walls, since the vectors were orthonormal
};

}  // namespace ballpiston
