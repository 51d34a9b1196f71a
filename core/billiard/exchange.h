// The collision of ball and piston: they exchange their horizontal components (the paper's
// eq. tv1tv2tv3ep).
#pragma once

#include <cmath>
#include <type_traits>

#include "core/geometry/pair_state.h"

namespace ballpiston {

// 1/|a| by one Newton step, which is enough if |a| differs from 1 by rounding only.
template <typename Vector>
auto OneOverLength(const Vector& a) {
  using Real = typename Vector::Scalar;
  return static_cast<Real>(1.5) - static_cast<Real>(0.5) * a.squaredNorm();
}

// std::copysign, also for Boost's 128-bit type, which lacks it.
template <typename Real>
Real WithSignOf(const Real& signed_number, const Real& magnitude) {
  if constexpr (std::is_floating_point_v<Real>) {
    return std::copysign(magnitude, signed_number);
  } else {
    return signbit(signed_number) ? -magnitude : magnitude;
  }
}

// The state after a ball and a piston in contact have exchanged. `speed` is sqrt(2 E), E the energy
// of both. The function computes the smaller of the two new speeds from the components, and the
// larger from the energy.
template <typename Real>
PairStateOf<Real> AfterExchange(const PairStateOf<Real>& before, const Real& speed) {
  using std::fabs, std::sqrt;
  PairStateOf<Real> after = before;
  const Real v1 = before.ball_speed * before.direction.x();
  const Real v2 = before.ball_speed * before.direction.y();
  const Real v3 = before.piston_velocity;
  Real ball = sqrt(v3 * v3 + v2 * v2), piston = fabs(v1);
  if (ball < piston) {
    piston = sqrt((speed - ball) * (speed + ball));
  } else {
    ball = sqrt((speed - piston) * (speed + piston));
  }
  if (ball > 0) after.direction = {v3 / ball, v2 / ball};
  after.direction *= OneOverLength(after.direction);
  after.ball_speed = ball;
  after.position.x() = before.piston;
  after.piston_velocity = WithSignOf(v1, piston);
  return after;
}

}  // namespace ballpiston
