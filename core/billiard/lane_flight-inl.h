// One flight of the ball, wall to wall, in every lane of a vector; frame and symbols of
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
// In the next disc's frame the cell lies toward (-, -) after (1, 1): a turn by 180 degrees, and
//   (h, e) becomes -(h cos + e sin, e cos - h sin).
// After (1, 0) it lies toward (-, +): a turn by 90 degrees, which is the same with (e, -h) in place
// of (h, e). So with x = u_x and y = u_y, where (1, 1) is hit, and both 0 elsewhere,
//   n = h - x,   h2 = e + y,   c' = c + e - n,   f' = f1 + y,
//   h' = -(h2 cos - n sin),   e' = n cos + h2 sin:
// additions in place of a choice between two cases.
//
// Nothing here asks that the ball has just left the disc at the origin. A ball anywhere in the cell
// will do, with u_x >= 0 and u_y >= 0: it cannot hit the discs behind it (FrameOfBall).
//
// h, e, c and s are kept in units of rho/sqrt(2). Then cos = 1 - s'^2 and sin = -s' c': no factor,
// and the cosine need not wait for the root.
//
// |u| would do a random walk by rounding; one Newton step a flight, of the direction before, keeps
// h^2 + e^2 at 1/2.
//
// A flight is a chain of some 60 cycles, of which a processor overlaps little more than one. So it
// has three stages that are joined by memory (Aim, FindRoot, Turn), and other balls are in other
// stages: nothing that a stage needs was begun just before. The compass changes by exclusive or, a
// bit for each lane, beside the vectors.
#if defined(BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_
#undef BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_
#else
#define BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_
#endif

#include <hwy/highway.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/billiard/lane_frame.h"
#include "core/geometry/pair_geometry.h"

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

template <typename T>
inline constexpr size_t kMostLanes = HWY_MAX_BYTES / sizeof(T);

// A vector of balls. The compass is in bits, one for each lane: a and m are set for -1, ab where a
// and b have different signs.
template <typename T>
struct Balls {
  HWY_ALIGN T h[kMostLanes<T>], e[kMostLanes<T>], c[kMostLanes<T>], s[kMostLanes<T>];
  HWY_ALIGN T path[kMostLanes<T>];  // so far
  uint32_t a, ab, m;

  void Set(size_t lane, const LaneFrame& frame) {
    h[lane] = static_cast<T>(frame.h);
    e[lane] = static_cast<T>(frame.e);
    c[lane] = static_cast<T>(frame.c);
    s[lane] = static_cast<T>(frame.s);
    SetBit(a, lane, frame.a < 0);
    SetBit(ab, lane, frame.a != frame.b);
    SetBit(m, lane, frame.m < 0);
  }
  LaneFrame Frame(size_t lane) const {
    return {h[lane], e[lane], c[lane], s[lane], Sign(a, lane), Sign(a ^ ab, lane), Sign(m, lane)};
  }

 private:
  static void SetBit(uint32_t& bits, size_t lane, bool bit) {
    bits = (bits & ~(uint32_t{1} << lane)) | uint32_t{bit} << lane;
  }
  static double Sign(uint32_t bits, size_t lane) { return (bits >> lane & 1) != 0 ? -1 : 1; }
};

template <class D>
HWY_INLINE uint32_t Bits(D d, hn::Mask<D> mask) {
#if HWY_TARGET <= HWY_AVX3
  (void)d;
  return mask.raw;
#else
  uint8_t bytes[8];  // of 8 lanes at most
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0];
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
HWY_INLINE uint32_t SignBits(D d, V v) {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4
  return Bits(d, hn::MaskFromVec(v));  // there it looks at sign bits only
#else
  return Bits(d, SignMask(d, v));
#endif
}

// The first stage: which disc is hit, and where. Leaves n, h2, s'^2 and f' in h, e, s and path of
// `to`, and returns s'^2: below 0, and not by rounding, the ball has left the cell. `from` and `to`
// may be the same.
template <typename T>
HWY_INLINE hn::Vec<hn::ScalableTag<T>> Aim(const FlightConstants<T>& k, const Balls<T>& from,
                                           Balls<T>& to) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  const V h = hn::Load(d, from.h);
  const V before = hn::Load(d, from.e);
  const V side = hn::Add(hn::Load(d, from.c), before);
  const V e = hn::Xor(before, hn::And(side, hn::SignBit(d)));  // mirrored if need be
  const V c = hn::Abs(side);                                   // + e
  const V y = hn::Sub(h, e), x = hn::Add(h, e);
  const V below_tip = hn::NegMulAdd(y, hn::Set(d, k.tip), c);
  const V c1 = hn::Sub(c, h);
  const V foot1 = hn::Sub(x, hn::Load(d, from.s));
  const V chord = hn::MulAdd(x, c1, hn::Set(d, k.half_height));
  const V off_chord = hn::Or(hn::Or(foot1, hn::Add(c1, hn::Set(d, k.sqrt_2))), chord);
  const V ahead = hn::And(below_tip, off_chord);  // negative: hits the disc at (1, 1)
  const hn::Mask<decltype(d)> is_ahead = SignMask(d, ahead);
  const V y_ahead = hn::IfThenElseZero(is_ahead, y);
  const V n = hn::Sub(h, hn::IfThenElseZero(is_ahead, x));
  const V next_c = hn::Sub(c, n);
  const V square = hn::NegMulAdd(next_c, next_c, hn::Set(d, T(2)));
  hn::Store(n, d, to.h);
  hn::Store(hn::Add(e, y_ahead), d, to.e);
  hn::Store(next_c, d, to.c);
  hn::Store(square, d, to.s);
  hn::Store(hn::Add(foot1, y_ahead), d, to.path);

  // The compass is mirrored, which turns b and m, then turned by 180 degrees, or by 90 after (1,
  // 0).
  const uint32_t mirrored = SignBits(d, side), beside = ~SignBits(d, ahead);
  const uint32_t ab = from.ab ^ mirrored;
  to.a = ~(from.a ^ (ab & beside));
  to.ab = ab ^ beside;
  to.m = from.m ^ mirrored;
  return square;
}

// The second stage: the root s'. Where rounding lets a ray miss its disc by some ulps, s'^2 is
// negative, and s' is 0.
template <typename T>
HWY_INLINE void FindRoot(Balls<T>& to) {
  const hn::ScalableTag<T> d;
  hn::Store(hn::Sqrt(hn::Max(hn::Load(d, to.s), hn::Zero(d))), d, to.s);
}

// The last stage; `path` is what the balls had gone before.
template <typename T>
HWY_INLINE void Turn(const FlightConstants<T>& k, hn::Vec<hn::ScalableTag<T>> path, Balls<T>& to) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  const V n = hn::Load(d, to.h), h2 = hn::Load(d, to.e), c = hn::Load(d, to.c);
  const V s = hn::Load(d, to.s);
  const V unit = hn::NegMulAdd(hn::MulAdd(n, n, hn::Mul(h2, h2)), hn::Set(d, k.length_squared),
                               hn::Set(d, T(1.5)));
  const V square = hn::NegMulAdd(c, c, hn::Set(d, T(2)));
  const V p = hn::MulSub(square, unit, unit);
  const V r = hn::Mul(hn::Mul(c, unit), s);
  hn::Store(hn::NegMulAdd(n, r, hn::Mul(h2, p)), d, to.h);
  hn::Store(hn::NegMulSub(h2, r, hn::Mul(n, p)), d, to.e);
  const V length = hn::Max(hn::Sub(hn::Load(d, to.path), s), hn::Zero(d));
  hn::Store(hn::Add(path, length), d, to.path);
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#endif
