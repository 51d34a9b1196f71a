// Rounds a number that depends on functions of the C library to 30 bits.
//
// The last bits of the library's sine depend on the processor. So do the last bits of a mean free
// time, and of every sum measured in units of it. After rounding to 30 bits the difference remains
// only for about one geometry in a million, next to a rounding edge. Rounding changes results by
// much less than their statistical errors.
#pragma once

#include <cmath>

namespace ballpiston {

inline double WithoutLastBits(double x) {
  int exponent;
  const double mantissa = std::frexp(x, &exponent);
  return std::ldexp(std::round(mantissa * 0x1p30), exponent - 30);
}

}  // namespace ballpiston
