// Numbers with 113 bits (from Boost): the reference for results in double. A formula that loses
// eighteen digits here still has as many correct digits as a double. Only tests and tools use them;
// the engines do not.
#pragma once

#include <limits>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#include <boost/multiprecision/float128.hpp>
#else
#include <boost/multiprecision/cpp_bin_float.hpp>
#endif

namespace ballpiston {

// GCC's own 113 bits on x86, about 20 ns per operation. As measured, its products are four times
// and its roots nine times as fast as Boost's.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
using Quad = boost::multiprecision::float128;
#else
using Quad = boost::multiprecision::cpp_bin_float_quad;
#endif

inline Quad QuadPi() { return 4 * atan(Quad{1}); }

// |value/exact - 1|. If exact is zero: zero if value is zero, else infinity.
inline double RelativeError(double value, const Quad& exact) {
  if (exact == 0) return value == 0 ? 0 : std::numeric_limits<double>::infinity();
  return static_cast<double>(fabs((Quad{value} - exact) / exact));
}

}  // namespace ballpiston
