// One flight of the ball, from wall to wall, in every lane of a vector. lane_frame.h defines the
// frame and the symbols. Included once for each instruction set.
//
// For a disc displaced by D from the disc just left, the ray's impact parameter is c + u x D, and
// the distance to its foot is u . D - s. This needs one addition each for the three candidates at
// (1, 0), (0, 1) and (1, 1). The sign of c + e = u x (cell's centre - ball) tells on which side the
// ray passes the centre. If the ray passes above, the frame is mirrored. Then the ray passes below,
// and cannot hit the disc at (0, 1). Two candidates remain:
//   c1 = c - u_y, foot f1 = u_x - s;        beyond it (1, 1):  c2 = c1 + u_x, f2 = f1 + u_y.
// The two discs meet at the tip t = (1 - lambda/2, 1/2). A ray below the tip, u x (t - ball) =
// c + e - u_y (1/2 - lambda/2) > 0, hits the disc at (1, 0). A ray above the tip hits this disc
// only with a chord that lies between the tips:
//   c1 > -rho, f1 > 0 and the chord's foot at height -u_x c1 < 1/2.
// These four signs decide which disc is hit. With the c' of this disc,
// s' = sqrt(rho^2 - c'^2), the length is f' - s', and the direction turns by the angle with
//   cos = 1 - 2 s'^2/rho^2,   sin = -2 s' c'/rho^2.
// In the frame of the disc (1, 1) the cell lies toward (-, -), so the frame turns by 180 degrees:
//   (h, e) becomes -(h cos + e sin, e cos - h sin).
// In the frame of the disc (1, 0) it lies toward (-, +), so the frame turns by 90 degrees: the same
// formula with (e, -h) in place of (h, e). Let x = u_x and y = u_y if (1, 1) is hit, else x = y =
// 0. Then
//   n = h - x,   h2 = e + y,   c' = c + e - n,   f' = f1 + y,
//   h' = -(h2 cos - n sin),   e' = n cos + h2 sin:
// which uses additions instead of a choice between two cases.
//
// The formulas hold also if the ball has not just left the disc at the origin. The ball may be
// anywhere in the cell with u_x >= 0 and u_y >= 0: it cannot hit the discs behind it (FrameOfBall).
//
// h, e, c and s are kept in units of rho/sqrt(2). Then cos = 1 - s'^2 and sin = -s' c' need no
// factor, and the cosine does not wait for the square root.
//
// Rounding would let |u| do a random walk. One Newton step in each flight, on the direction before
// the turn, keeps h^2 + e^2 at 1/2.
//
// A flight is a dependency chain of about 60 cycles, and a processor can overlap little more than
// one such chain. So a flight has three stages (Aim, FindRoot, Turn) that pass their results
// through memory. Other balls are in other stages, so no stage waits for a result that was started
// just before. The compass has one bit for each lane and changes by exclusive or.
#if defined(BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_
#undef BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_
#else
#define BALLPISTON_CORE_BILLIARD_LANE_FLIGHT_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "core/billiard/lane_constants.h"
#include "core/billiard/lane_frame.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

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
  // Without a branch, which would be mispredicted half of the time.
  static double Sign(uint32_t bits, size_t lane) {
    return 1 - 2 * static_cast<double>(static_cast<int>(bits >> lane & 1));
  }
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

// The lanes in which the sign bit is set.
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
  return Bits(d, hn::MaskFromVec(v));  // on these targets MaskFromVec reads sign bits only
#else
  return Bits(d, SignMask(d, v));
#endif
}

// The first stage: finds the disc that is hit, and the place. Writes n, h2, c', s'^2 and f' into h,
// e, c, s and path of `to`. Returns s'^2. If s'^2 is below 0 by more than rounding, the ball has
// left the cell. `from` and `to` may be the same.
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

  // Mirrors the compass, which changes the signs of b and m. Then turns it by 180 degrees, or by 90
  // after a hit of (1, 0).
  const uint32_t mirrored = SignBits(d, side), beside = ~SignBits(d, ahead);
  const uint32_t ab = from.ab ^ mirrored;
  to.a = ~(from.a ^ (ab & beside));
  to.ab = ab ^ beside;
  to.m = from.m ^ mirrored;
  return square;
}

// The second stage: the root s'. If rounding lets a ray miss its disc by some ulps, s'^2 is
// negative, and s' is set to 0.
template <typename T>
HWY_INLINE void FindRoot(Balls<T>& to) {
  const hn::ScalableTag<T> d;
  hn::Store(hn::Sqrt(hn::Max(hn::Load(d, to.s), hn::Zero(d))), d, to.s);
}

// The last stage. `path` is the length of the balls' paths before this flight.
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
