// One flight of the ball, wall to wall, in every lane of some vectors; frame and symbols of
// lane_frame.h. Included once for each instruction set.
//
// For a disc displaced by D from the one just left, the ray's impact parameter is c + u x D and the
// distance to its foot u . D - s: an addition each for the three candidates at (1, 0), (0, 1) and
// (1, 1). c + e = u x (cell's centre - ball) tells on which side the ray passes the centre;
// mirrored if need be, it passes below, so that of the two discs beside only the one at (1, 0) can
// be hit:
//   c1 = c - u_y, foot f1 = u_x - s;        beyond it (1, 1):  c2 = c1 + u_x, f2 = f1 + u_y.
// The two meet at the tip t = (1 - lambda/2, 1/2). A ray below the tip, u x (t - ball) =
// c + e - u_y (1/2 - lambda/2) > 0, hits the disc at (1, 0). One above hits it only with a chord
// that lies between the tips:
//   c1 > -rho, f1 > 0 and the chord's foot at height -u_x c1 < 1/2.
// So which it is, is a matter of four signs. Then, with the c' of the disc that is hit,
// s' = sqrt(rho^2 - c'^2), length f' - s', and the direction turns by the angle with
//   cos = 1 - 2 s'^2/rho^2,   sin = -2 s' c'/rho^2.
// In the next disc's frame the cell lies toward (-, +) after (1, 0) and (-, -) after (1, 1): one
// more turn by -90 or 180 degrees. In all, (h, e) becomes -(h cos + e sin, e cos - h sin) after
// (1, 1); after (1, 0) the mirrored frame is taken, which is the same with h and e exchanged and
// c' reversed beforehand.
//
// h, e, c and s are kept in units of rho/sqrt(2). Then cos = 1 - s'^2 and sin = -s' c': no factor,
// and the cosine need not wait for the root.
//
// |u| would do a random walk by rounding; one Newton step a flight, of the direction before, keeps
// h^2 + e^2 at 1/2.
//
// K vectors fly at once, operation by operation: a flight is a chain of some 60 cycles, and vector
// after vector a processor would see hardly more than one chain at a time.
#if defined(BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_
#undef BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_
#else
#define BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_
#endif

#include <hwy/highway.h>

#include <cmath>
#include <cstddef>

#include "core/geometry/pair_geometry.h"

// For all K vectors; unrolled, or the arrays would not be kept in registers.
#undef BALLPISTON_EACH
#define BALLPISTON_EACH _Pragma("GCC unroll 8") for (size_t i = 0; i < K; ++i)

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <typename T>
struct FlightConstants {
  explicit FlightConstants(const PairGeometry& geometry)
      : scale(M_SQRT2 / geometry.rho()),
        sqrt_2(static_cast<T>(M_SQRT2)),
        half_height(static_cast<T>(scale * scale / 2)),
        length_squared(static_cast<T>(1 / (scale * scale))),
        tip(static_cast<T>(0.5 - geometry.lambda() / 2)) {}

  double scale;  // of h, e, c, s and lengths in lanes
  T sqrt_2;      // rho
  T half_height;
  T length_squared;
  T tip;  // from the cell's centre
};

// K vectors of balls on walls.
template <class D, size_t K>
struct Balls {
  // Written down for HWY_INLINE: GCC compiles an implicit constructor for no instruction set, and
  // cannot inline the constructors of NEON's vectors into it.
  HWY_INLINE Balls() = default;

  hn::Vec<D> h[K], e[K], c[K], s[K];
  hn::Vec<D> a[K], b[K], m[K];
};

// Exchanges x and y where `mask` is not set.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void SwapUnless(D d, hn::Mask<D> mask, V& x, V& y) {
#if HWY_TARGET <= HWY_AVX3
  (void)d;
  const V before = x;
  x = hn::IfThenElse(mask, x, y);
  y = hn::IfThenElse(mask, y, before);
#else
  // A select is three operations on some processors, and these are four for both.
  const V difference = hn::AndNot(hn::VecFromMask(d, mask), hn::Xor(x, y));
  x = hn::Xor(x, difference);
  y = hn::Xor(y, difference);
#endif
}

// Where the sign bit is set.
template <class D, class V = hn::Vec<D>>
HWY_INLINE hn::Mask<D> SignMask(D d, V v) {
#if HWY_TARGET <= HWY_AVX3
  (void)d;
  return hn::MaskFromVec(v);
#else
  const hn::RebindToSigned<D> integers;
  return hn::RebindMask(d, hn::Lt(hn::BitCast(integers, v), hn::Zero(integers)));
#endif
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V IfNegative(D d, V v, V yes, V no) {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4
  (void)d;
  return hn::IfThenElse(hn::MaskFromVec(v), yes, no);  // there it looks at sign bits only
#else
  return hn::IfThenElse(SignMask(d, v), yes, no);
#endif
}

// Flies every ball to the next wall, and reflects it there. `missed` is c'^2 - rho^2: more than
// rounding above 0, the ball has left the cell.
template <class D, size_t K, typename T = hn::TFromD<D>, class V = hn::Vec<D>>
HWY_INLINE void Fly(D d, const FlightConstants<T>& k, Balls<D, K>& balls, V (&length)[K],
                    V (&missed)[K]) {
  const V sign = hn::SignBit(d), zero = hn::Zero(d);
  auto& [h, e, c, s, a, b, m] = balls;
  V mirror[K], x[K], y[K], tip[K], chord[K], foot[K], unit[K], q[K], p[K], r[K], w[K], flip[K];
  hn::Mask<D> ahead[K];  // hits the disc at (1, 1)
  BALLPISTON_EACH c[i] = hn::Add(c[i], e[i]);
  BALLPISTON_EACH mirror[i] = hn::And(c[i], sign);
  BALLPISTON_EACH c[i] = hn::Abs(c[i]);
  BALLPISTON_EACH e[i] = hn::Xor(e[i], mirror[i]);
  BALLPISTON_EACH y[i] = hn::Sub(h[i], e[i]);
  BALLPISTON_EACH x[i] = hn::Add(h[i], e[i]);
  BALLPISTON_EACH tip[i] = hn::NegMulAdd(y[i], hn::Set(d, k.tip), c[i]);
  BALLPISTON_EACH c[i] = hn::Sub(c[i], h[i]);  // c1
  BALLPISTON_EACH foot[i] = hn::Sub(x[i], s[i]);
  BALLPISTON_EACH chord[i] = hn::MulAdd(x[i], c[i], hn::Set(d, k.half_height));
  BALLPISTON_EACH w[i] = hn::Or(foot[i], hn::Add(c[i], hn::Set(d, k.sqrt_2)));
  BALLPISTON_EACH tip[i] = hn::And(tip[i], hn::Or(w[i], chord[i]));
  BALLPISTON_EACH ahead[i] = SignMask(d, tip[i]);
  BALLPISTON_EACH c[i] = IfNegative(d, tip[i], hn::Add(c[i], x[i]), c[i]);
  BALLPISTON_EACH foot[i] = hn::Add(foot[i], hn::IfThenElseZero(ahead[i], y[i]));
  BALLPISTON_EACH missed[i] = hn::MulSub(c[i], c[i], hn::Set(d, T(2)));
  // Of a ray that rounding lets miss the disc the root is as good as 0.
  BALLPISTON_EACH q[i] = hn::Abs(missed[i]);
  BALLPISTON_EACH s[i] = hn::Sqrt(q[i]);
  BALLPISTON_EACH unit[i] = hn::MulAdd(h[i], h[i], hn::Mul(e[i], e[i]));
  BALLPISTON_EACH unit[i] =
      hn::NegMulAdd(unit[i], hn::Set(d, k.length_squared), hn::Set(d, T(1.5)));
  // Into the mirrored frame after (1, 0), then the turn.
  BALLPISTON_EACH flip[i] = hn::IfThenZeroElse(ahead[i], sign);
  BALLPISTON_EACH c[i] = hn::Xor(c[i], flip[i]);
  BALLPISTON_EACH SwapUnless(d, ahead[i], h[i], e[i]);
  BALLPISTON_EACH p[i] = hn::MulSub(q[i], unit[i], unit[i]);
  BALLPISTON_EACH r[i] = hn::Mul(c[i], unit[i]);
  BALLPISTON_EACH w[i] = hn::Mul(e[i], p[i]);
  BALLPISTON_EACH p[i] = hn::Mul(h[i], p[i]);
  BALLPISTON_EACH b[i] = hn::Xor(b[i], mirror[i]);
  BALLPISTON_EACH SwapUnless(d, ahead[i], a[i], b[i]);
  BALLPISTON_EACH a[i] = hn::Neg(a[i]);
  BALLPISTON_EACH b[i] = hn::Neg(b[i]);
  BALLPISTON_EACH m[i] = hn::Xor(m[i], hn::Xor(mirror[i], flip[i]));
  BALLPISTON_EACH r[i] = hn::Mul(r[i], s[i]);
  BALLPISTON_EACH w[i] = hn::NegMulAdd(h[i], r[i], w[i]);
  BALLPISTON_EACH h[i] = hn::MulAdd(e[i], r[i], p[i]);
  BALLPISTON_EACH e[i] = w[i];
  BALLPISTON_EACH length[i] = hn::Max(hn::Sub(foot[i], s[i]), zero);
}

// The balls' scale^2 (x - origin), x in the cell; `origin` scaled likewise.
template <class D, size_t K, typename T = hn::TFromD<D>, class V = hn::Vec<D>>
HWY_INLINE void Abscissae(D d, const FlightConstants<T>& k, const Balls<D, K>& balls, T origin,
                          V (&x)[K]) {
  const auto& [h, e, c, s, a, b, m] = balls;
  // (q_x + q_y - 1)/2 and (q_x - q_y)/2, for x = (q - (1, 1)/2) . r.
  V along[K], across[K];
  BALLPISTON_EACH along[i] = hn::MulSub(s[i], h[i], hn::Set(d, k.half_height));
  BALLPISTON_EACH across[i] = hn::Mul(s[i], e[i]);
  BALLPISTON_EACH along[i] = hn::NegMulAdd(c[i], e[i], along[i]);
  BALLPISTON_EACH across[i] = hn::MulAdd(c[i], h[i], across[i]);
  BALLPISTON_EACH x[i] = hn::MulSub(a[i], along[i], hn::Set(d, origin));
  BALLPISTON_EACH x[i] = hn::MulAdd(b[i], across[i], x[i]);
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#endif
