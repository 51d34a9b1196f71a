// One flight of the ball, wall to wall, in every lane of a vector; frame and symbols of
// lane_frame.h. Included once for each instruction set.
//
// For a disc displaced by D from the one just left, the ray's impact parameter is c + u x D and the
// distance to its foot u . D - s: an addition each for the three candidates at (1, 0), (0, 1) and
// (1, 1). c + e = u x (cell's centre - ball) tells on which side the ray passes the centre;
// mirrored if need be, it passes below, so that of the two discs beside only the one at (1, 0) can
// be hit:
//   c1 = c - u_y, foot f1 = u_x - s;        beyond it (1, 1):  c2 = c1 + u_x, f2 = f1 + u_y.
// The two meet at the tip t = (1 - lambda/2, 1/2). A ray below the tip, u x (t - ball) > 0, hits
// the disc at (1, 0). One above hits it only with a chord that lies between the tips:
//   c1 > -rho, f1 > 0 and the chord's foot 1 - ... at height -u_x c1 < 1/2.
// So "beside" is the sign of max(tip, min(c1 + rho, f1, u_x c1 + 1/2)). Then, with the c' of the
// disc that is hit, s' = sqrt(rho^2 - c'^2), length f' - s', and the direction turns by the angle
// with
//   cos = 1 - 2 s'^2/rho^2,   sin = -2 s' c'/rho^2.
// In the next disc's frame the cell lies toward (-, +) after (1, 0) and (-, -) after (1, 1):
// another turn by -90 or 180 degrees (the former followed by the mirror that keeps c' as it is). In
// terms of (h, e) a turn by an angle is h cos - e sin, e cos + h sin with the sign of sin reversed.
//
// |u| would do a random walk by rounding; one Newton step a flight keeps h^2 + e^2 at 1/2.
#if defined(BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_
#undef BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_
#else
#define BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_
#endif

#include <hwy/highway.h>

#include "core/geometry/pair_geometry.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <typename T>
struct FlightConstants {
  explicit FlightConstants(const PairGeometry& geometry)
      : rho(static_cast<T>(geometry.rho())),
        rho_squared(static_cast<T>(geometry.rho() * geometry.rho())),
        two_over_rho_squared(static_cast<T>(2 / (geometry.rho() * geometry.rho()))),
        tip_h(static_cast<T>(geometry.lambda() / 2 - 0.5)),
        tip_e(static_cast<T>(1.5 - geometry.lambda() / 2)) {}

  T rho;
  T rho_squared;
  T two_over_rho_squared;
  T tip_h;  // u x t = h tip_h + e tip_e
  T tip_e;
};

template <class D>
struct Ball {
  hn::Vec<D> h, e, c, s;
};

template <class D>
struct Compass {
  hn::Vec<D> a, b, m;
};

template <class D>
struct Flight {
  Ball<D> ball;  // after the hit at its end
  hn::Vec<D> length;
  hn::Vec<D> mirror;  // its sign: -0 where the frame was mirrored first
  hn::Mask<D> ahead;  // hit the disc at (1, 1)
};

template <class D, typename T = hn::TFromD<D>>
HWY_INLINE Flight<D> Fly(D d, const FlightConstants<T>& k, const Ball<D>& from) {
  using V = hn::Vec<D>;
  const V zero = hn::Zero(d), half = hn::Set(d, T(0.5));
  const V mirror = hn::And(hn::Add(from.c, from.e), hn::SignBit(d));
  const V c = hn::Xor(from.c, mirror), e = hn::Xor(from.e, mirror), h = from.h;
  const V x = hn::Add(h, e), y = hn::Sub(h, e);
  const V c1 = hn::Sub(c, y), f1 = hn::Sub(x, from.s);
  const V tip = hn::MulAdd(e, hn::Set(d, k.tip_e), hn::MulAdd(h, hn::Set(d, k.tip_h), c));
  const V chord = hn::Min(hn::Min(hn::Add(c1, hn::Set(d, k.rho)), hn::MulAdd(x, c1, half)), f1);
  const auto ahead = hn::Le(hn::Max(tip, chord), zero);
  const V c2 = hn::Add(c1, hn::IfThenElseZero(ahead, x));
  const V f2 = hn::Add(f1, hn::IfThenElseZero(ahead, y));
  const V s2 = hn::Sqrt(hn::Max(hn::NegMulAdd(c2, c2, hn::Set(d, k.rho_squared)), zero));
  // Minus cosine and minus sine of the turn; then the frame's own turn swaps or keeps them.
  const V twice = hn::Mul(s2, hn::Set(d, k.two_over_rho_squared));
  const V p = hn::MulSub(twice, s2, hn::Set(d, T(1))), r = hn::Mul(twice, c2);
  const V cosine = hn::IfThenElse(ahead, p, hn::Neg(r)), sine = hn::IfThenElse(ahead, r, p);
  const V h2 = hn::MulAdd(e, sine, hn::Mul(h, cosine));
  const V e2 = hn::NegMulAdd(h, sine, hn::Mul(e, cosine));
  const V unit = hn::Sub(hn::Set(d, T(1.5)), hn::MulAdd(h2, h2, hn::Mul(e2, e2)));
  return {{hn::Mul(h2, unit), hn::Mul(e2, unit), c2, s2}, hn::Sub(f2, s2), mirror, ahead};
}

// The compass of the frame after that flight: turned as h and e, by right angles.
template <class D>
HWY_INLINE Compass<D> Turned(D /*d*/, const Compass<D>& from, const Flight<D>& flight) {
  const auto b = hn::Xor(from.b, flight.mirror);
  return {hn::Neg(hn::IfThenElse(flight.ahead, from.a, b)),
          hn::IfThenElse(flight.ahead, hn::Neg(b), from.a), hn::Xor(from.m, flight.mirror)};
}

// How far left of the discs' centres, x = 1/2 - depth, a ball on a disc beside the right tip is; on
// the other two discs more than any depth.
template <class D, typename T = hn::TFromD<D>>
HWY_INLINE hn::Vec<D> DepthAtRightTip(D d, const Ball<D>& ball, const Compass<D>& compass) {
  // The smaller of q's components for a disc beside the tip: q_y if r = (0, -1), q_x if (-1, 0).
  const auto sum = hn::NegMulAdd(ball.c, ball.e, hn::Mul(ball.s, ball.h));      // (q_x + q_y)/2
  const auto difference = hn::MulAdd(ball.c, ball.h, hn::Mul(ball.s, ball.e));  // (q_x - q_y)/2
  const auto depth = hn::NegMulAdd(compass.b, difference, sum);
  return hn::IfThenElse(hn::Lt(compass.a, hn::Zero(d)), depth, hn::Set(d, T(4)));
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#endif
