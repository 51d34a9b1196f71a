// The two growing directions of the tangent space, followed from collision to collision
// (tangent_map.h has the maps).
//
// Differences along the flow and in energy are left out. Then dr and dw are across w = (v u, p), in
// the plane of the two unit vectors (u the ball's direction, v its speed, p the piston's velocity)
//   e1 = (u_perp, 0),   e2 = (p u, -v).
// A tangent vector has two parts: (a, A) of the ball and (b, B) of both bodies, with
// dr = a e1 + b e2 and dw = A e1 + B e2. In a wait of time t
//   (a, A/v)' = BallMap (a, A/v),   (b, B)' = (b + t B, B).
// Each wall hit of the ball changes the sign of (a, A), and each wall hit of the piston that of
// (b, B). At a collision the components x and q of e1 and e2 are exchanged, and e1', e2' are those
// of the velocities after it. With u = (cos alpha, sin alpha), (a, b) and (A, B) are mapped by the
// same reflection:
//   ( p cos alpha    sin alpha   )
//   ( sin alpha     -p cos alpha )  /  sqrt(p^2 + v^2 sin^2 alpha).
//
// Two vectors span a plane, which turns to the directions of lambda_1 and lambda_2. After each wait
// Gram and Schmidt's method makes them orthonormal, and the logarithms of the factors are added up.
// In a long wait both vectors grow in the same direction, by factors beyond the range of a double.
// The part of the second vector that remains after the subtraction is computed without cancellation
// (tangent_plane.cc).
//
// Properties, each with a test of its name: 1. TheReflectionOfAnExchangeIsThatOfSixComponents.
// 2. LongWaitsNeedNoRangeOfExponents.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "core/billiard/orbits.h"
#include "core/billiard/tangent_map.h"

namespace ballpiston {

class TangentPlane {
 public:
  static constexpr size_t kExponents = 2;

  // The velocities across w. Their components are the same for every start.
  TangentPlane() = default;
  TangentPlane(const PairGeometry&, const PairState& /*start*/) {}

  // Follows a wait and the collision that ends it. Needs `collision.flights`.
  void Collide(const Collision& collision);

  // The logarithms of the factors by which the two directions have grown since the last call.
  std::array<double, kExponents> TakeGrowth();

 private:
  struct Tangent {
    Eigen::Vector2d ball;  // (a, A)
    Eigen::Vector2d both;  // (b, B)
  };

  void Wait(const BallMap& flights, double ball_speed, double time, double sign);
  void Exchange(const PairState& before);

  std::array<Tangent, kExponents> tangents_ = {{{{0, 1}, {0, 0}}, {{0, 0}, {0, 1}}}};
  std::array<double, kExponents> growth_ = {};
};

}  // namespace ballpiston
