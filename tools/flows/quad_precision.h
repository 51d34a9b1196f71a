// Arithmetic with 113 bits, the reference for results in double. A formula that loses eighteen
// digits here still has as many correct digits as a double. Only tests and the stability tables use
// this arithmetic; the engines do not.
//
// On x86 the type is __float128 with the compiler's libquadmath, elsewhere a long double of the
// same format. The functions are declared here because quadmath.h is in a folder of GCC that other
// compilers do not search.
#pragma once

#include <cmath>
#include <limits>

#ifdef __x86_64__
extern "C" {
__float128 sqrtq(__float128) noexcept;
__float128 sinq(__float128) noexcept;
__float128 cosq(__float128) noexcept;
__float128 asinq(__float128) noexcept;
__float128 atanq(__float128) noexcept;
}
#endif

namespace ballpiston {

inline double Sqrt(double x) { return std::sqrt(x); }
inline double Sin(double x) { return std::sin(x); }
inline double Cos(double x) { return std::cos(x); }
inline double Asin(double x) { return std::asin(x); }
inline double Atan(double x) { return std::atan(x); }

#ifdef __x86_64__
using Quad = __float128;
inline Quad Sqrt(Quad x) { return sqrtq(x); }
inline Quad Sin(Quad x) { return sinq(x); }
inline Quad Cos(Quad x) { return cosq(x); }
inline Quad Asin(Quad x) { return asinq(x); }
inline Quad Atan(Quad x) { return atanq(x); }
#else
using Quad = long double;
static_assert(std::numeric_limits<Quad>::digits >= 113);
inline Quad Sqrt(Quad x) { return std::sqrt(x); }
inline Quad Sin(Quad x) { return std::sin(x); }
inline Quad Cos(Quad x) { return std::cos(x); }
inline Quad Asin(Quad x) { return std::asin(x); }
inline Quad Atan(Quad x) { return std::atan(x); }
#endif

inline Quad QuadPi() { return 4 * Atan(Quad{1}); }

// |value/exact - 1|. If exact is zero: zero if value is zero, else infinity.
inline double RelativeError(double value, Quad exact) {
  if (exact == 0) return value == 0 ? 0 : std::numeric_limits<double>::infinity();
  const Quad error = (Quad{value} - exact) / exact;
  return static_cast<double>(error < 0 ? -error : error);
}

}  // namespace ballpiston
