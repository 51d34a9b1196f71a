// The elementary functions of a jump, in every lane of a vector. Included once for each instruction
// set. All operations are elementwise and fused as written. So on processors with fused
// multiply-add a lane's bits depend only on its arguments.
//
//   UniformOf(words)       CounterRandom's uniform numbers
//   MinusLog(x)            -log x         for x in [2^-53, 1)
//   SineOfQuarterTurn(a)   sin a          for a in [0, pi/2]
//   AngleOf(u, q)          atan2(u, q)    for u, q in [0, 1], not both 0
//
// Each of the last three is x + x^3 P(x^2) of an argument that was reduced to be close to 0. P is a
// minimax polynomial for the relative error of the whole (Remez's exchange at 50 digits). This
// error is 2e-18, 5e-18 and 3e-18 with rounded coefficients, so the rounding of operations
// dominates: a few units in the last place.
//
// Logarithm. x = 2^e m with m in [sqrt(1/2), sqrt 2); -log x = -e log 2 + 2 atanh z,
// z = (1 - m)/(1 + m), where 1 - m is exact. The two terms cancel by half at most.
//
// Angle. The series is short for |r| <= tan(pi/8):
//     A = atan(u/q)                      for u < tan(pi/8) q
//     A = pi/4 + atan((u - q)/(u + q))   between
//     A = pi/2 - atan(q/u)               for q < tan(pi/8) u
// One division serves all three cases. (Half of the angle, u/(sqrt(u^2 + q^2) + q), has two cases
// but needs one more square root, which costs more.)
//
// With Highway's Log, Sin and Asin a jump takes 1.25 times as long on AVX-512 and 1.3 times on
// AVX2, and its error is 1e-14.
#if defined(BALLPISTON_CORE_MARKOV_JUMP_PROCESS_FUNCTIONS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLPISTON_CORE_MARKOV_JUMP_PROCESS_FUNCTIONS_INL_H_
#undef BALLPISTON_CORE_MARKOV_JUMP_PROCESS_FUNCTIONS_INL_H_
#else
#define BALLPISTON_CORE_MARKOV_JUMP_PROCESS_FUNCTIONS_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// c0 + c1 x, and below c0 + ... + c3 x^3. Polynomials are summed by pairs (Estrin), because the
// chains of operations are shorter than in Horner's scheme.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V Linear(D d, V x, double c0, double c1) {
  return hn::MulAdd(hn::Set(d, c1), x, hn::Set(d, c0));
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V Cubic(D d, V x, V x2, double c0, double c1, double c2, double c3) {
  return hn::MulAdd(Linear(d, x, c2, c3), x2, Linear(d, x, c0, c1));
}

// 2 atanh z for |z| <= (sqrt 2 - 1)/(sqrt 2 + 1).
template <class D, class V = hn::Vec<D>>
HWY_INLINE V TwiceArtanh(D d, V z) {
  const V x = hn::Mul(z, z), x2 = hn::Mul(x, x);
  const V low = Cubic(d, x, x2, 0x1.5555555555592p-1, 0x1.999999997fdb2p-2, 0x1.24924941f1528p-2,
                      0x1.c71c520941b68p-3);
  const V high = hn::MulAdd(hn::Set(d, 0x1.2f0569e15cbe2p-3), x2,
                            Linear(d, x, 0x1.74663eeda5df5p-3, 0x1.39a1ba27916dep-3));
  const V p = hn::MulAdd(high, hn::Mul(x2, x2), low);
  return hn::MulAdd(hn::Mul(z, x), p, hn::Add(z, z));
}

// (k + 1/2)/2^52, where k is the upper 52 bits. A number in [1, 2) with these bits as its mantissa
// is 1 + k/2^52; the subtraction of 1 - 2^-53 is exact.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V UniformOf(D d, const uint64_t* words) {
  const hn::RebindToUnsigned<D> bits;
  const auto one_to_two =
      hn::Or(hn::ShiftRight<12>(hn::LoadU(bits, words)), hn::BitCast(bits, hn::Set(d, 1.0)));
  return hn::Sub(hn::BitCast(d, one_to_two), hn::Set(d, 1 - 0x1p-53));
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V MinusLog(D d, V x) {
  const hn::RebindToUnsigned<D> bits;
  // `over` is the bits of x minus the bits of sqrt(1/2): e above the mantissa, in two's complement.
  const auto root_half = hn::Set(bits, uint64_t{0x3fe6a09e667f3bcd});
  const auto over = hn::Sub(hn::BitCast(bits, x), root_half);
  const auto mantissa = hn::And(over, hn::Set(bits, (uint64_t{1} << 52) - 1));
  const V m = hn::BitCast(d, hn::Add(mantissa, root_half));
  // Puts -e >= 0 into the last bits of 2^52; the result is the number 2^52 - e.
  const auto minus_e = hn::ShiftRight<52>(hn::Sub(mantissa, over));
  const V magic = hn::Set(d, 0x1p52);
  const V e = hn::Sub(hn::BitCast(d, hn::Or(minus_e, hn::BitCast(bits, magic))), magic);
  const V one = hn::Set(d, 1.0);
  const V z = hn::Div(hn::Sub(one, m), hn::Add(one, m));
  return hn::MulAdd(e, hn::Set(d, 0x1.62e42fefa39efp-1), TwiceArtanh(d, z));  // log 2
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V SineOfQuarterTurn(D d, V a) {
  const V x = hn::Mul(a, a), x2 = hn::Mul(x, x);
  const V low = Cubic(d, x, x2, -0x1.5555555555555p-3, 0x1.11111111110c1p-7, -0x1.a01a01a0148b9p-13,
                      0x1.71de3a5287b33p-19);
  const V high = Cubic(d, x, x2, -0x1.ae6454cb4e4fdp-26, 0x1.6123cb26d51d7p-33,
                       -0x1.ae431d0c8f3afp-41, 0x1.882994c2a8b1ep-49);
  const V p = hn::MulAdd(high, hn::Mul(x2, x2), low);
  return hn::MulAdd(hn::Mul(a, x), p, a);
}

// For |r| <= tan(pi/8).
template <class D, class V = hn::Vec<D>>
HWY_INLINE V Arctan(D d, V r) {
  const V x = hn::Mul(r, r), x2 = hn::Mul(x, x), x4 = hn::Mul(x2, x2);
  const V low = Cubic(d, x, x2, -0x1.555555555553dp-2, 0x1.99999999958f8p-3, -0x1.24924922b1797p-3,
                      0x1.c71c70e7c759ap-4);
  const V middle = Cubic(d, x, x2, -0x1.745cf90f7ba6ap-4, 0x1.3b111cb59e7acp-4,
                         -0x1.10ebe156fb1edp-4, 0x1.df119f3220a59p-5);
  const V high = hn::MulAdd(hn::Set(d, -0x1.25a31e4d31110p-6), x2,
                            Linear(d, x, -0x1.9cdd2818410e2p-5, 0x1.37efdc661e3e5p-5));
  const V p = hn::MulAdd(hn::MulAdd(high, x4, middle), x4, low);
  return hn::MulAdd(hn::Mul(r, x), p, r);
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V AngleOf(D d, V u, V q) {
  const V tangent = hn::Set(d, 0x1.a827999fcef32p-2);  // of pi/8
  const auto not_flat = hn::Ge(u, hn::Mul(q, tangent));
  const auto steep = hn::Lt(q, hn::Mul(u, tangent));
  const V top = hn::IfThenElse(not_flat, hn::Sub(u, q), u);
  const V bottom = hn::Add(q, hn::IfThenElseZero(not_flat, u));
  const V from = hn::IfThenElseZero(not_flat, hn::Set(d, 0x1.921fb54442d18p-1));  // pi/4
  const V r = hn::Div(hn::IfThenElse(steep, hn::Neg(q), top), hn::IfThenElse(steep, u, bottom));
  return hn::Add(Arctan(d, r), hn::IfThenElse(steep, hn::Set(d, 0x1.921fb54442d18p+0), from));
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#endif  // BALLPISTON_CORE_MARKOV_JUMP_PROCESS_FUNCTIONS_INL_H_
