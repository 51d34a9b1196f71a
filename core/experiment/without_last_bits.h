// A number that the C library had a part in, to 30 bits.
//
// The library's sines round by the processor, so the last bits of a mean free time do, and would
// show in every sum of what is measured in its units. To 30 bits they do not, unless one geometry
// in a million hits the edge; no measurement could tell the difference.
#ifndef BALLPISTON_CORE_EXPERIMENT_WITHOUT_LAST_BITS_H_
#define BALLPISTON_CORE_EXPERIMENT_WITHOUT_LAST_BITS_H_

#include <cmath>

namespace ballpiston {

inline double WithoutLastBits(double x) {
  int exponent;
  const double mantissa = std::frexp(x, &exponent);
  return std::ldexp(std::round(mantissa * 0x1p30), exponent - 30);
}

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_WITHOUT_LAST_BITS_H_
