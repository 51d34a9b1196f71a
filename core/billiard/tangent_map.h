// The tangent map of the pair's flow: how the difference between two neighbouring orbits grows.
//
// All masses are 1, so ball and piston together are one point r = (x, y, q) with the velocity w,
// |w| = 1 at the energy 1/2. The point is a billiard in three dimensions: it flies straight, and
// reflects elastically from cylinders (the discs), from the planes q = const of the piston's ends,
// and from the plane x = q. Let (dr, dw) be the difference of two orbits at the same time.
//
//   Flight for a time T     dr' = dr + T dw,   dw' = dw.
//   Reflection, normal n    The other orbit hits the wall later, by delay = -(dr.n)/(w.n). With
//                           R = 1 - 2 n n^T and w' = R w the difference at one time is
//                           dr' = dr + delay w - delay w' = R dr.
//   at a flat wall          n is the same for both orbits: dw' = R dw.
//   at a disc               The other orbit hits the disc farther along its arc, by
//                           s = (dr + delay w).t, t being the unit tangent. There the normal is
//                           turned by s/rho: dn = t s/rho. The derivative of w - 2 (w.n) n is
//                           dw' = R dw - 2 (w.dn) n - 2 (w.n) dn = R dw + (2 v s/rho) u_perp,
//                           v being the ball's speed, u its direction after the hit, and u_perp
//                           the direction u turned by +90 degrees.
//   at the plane x = q      n = (1, 0, -1)/sqrt 2 for both orbits, wherever they meet. So R
//                           exchanges the components x and q, of dr and of dw.
//
// Two orbits that differ along the flow, (dr, dw) = (w, 0), or in energy, (0, w), stay at a
// distance that does not grow exponentially. The Lyapunov exponents of these two directions are 0.
// All maps preserve dw.w, and dr.w if dw.w = 0. They also preserve the areas dr1.dw2 - dr2.dw1, so
// the exponents are lambda_1, lambda_2, 0, 0, -lambda_2, -lambda_1. gas/pair_tangents.h follows
// all six, tangent_plane.h the first two.
//
// Between two exchanges the ball's difference across its path is independent of all others. Let a
// be this difference of positions, and theta that of directions. A flight of the length L adds
// L theta to a. A hit at the angle phi between ray and normal has s = a/cos(phi), so it adds
// 2 a/(rho cos(phi)) to theta. A hit also changes the signs of both, because a reflection exchanges
// left and right. BallMap is the product of these maps, without the signs.
#pragma once

#include <limits>

namespace ballpiston {

// Maps (a, theta) at the beginning of a wait to (a, theta) at its end, in cells and radians. The
// map is 2^exponent times the matrix. Its determinant is 1, also if the matrix has lost it to
// rounding.
struct BallMap {
  double aa = 1, at = 0;
  double ta = 0, tt = 1;
  double exponent = 0;
};

// A ball grazes with a smaller cos(phi) only by rounding.
template <typename Real>
inline constexpr double kSmallestCosine = std::numeric_limits<Real>::digits > 24 ? 1e-8 : 1e-4;

}  // namespace ballpiston
