// Derivation.
//
// Angle. With t = short side/long side in [0, 1] and c = k/8 the nearest eighth,
//     atan t = atan c + atan r,   r = (t - c)/(1 + c t),   |r| <= 1/16.
// The first term is from a table, the second from its series.
//
// Logarithm. With x = 2^e m, 1/sqrt2 <= m < sqrt2 and c = k/8 next to m,
//     log x = e log 2 + log c + 2 atanh s,   s = (m - c)/(m + c),   |s| < 1/22.
//
// Exponential. With k the whole number next to x/log 2 and r = x - k log 2, exp x = 2^k exp r. Here
// |r| <= log(2)/2, and exp r is by its series.
//
// log 2 is a sum of two numbers. The first has so few bits that its products with e and k are
// exact.
#include "core/arithmetic/elementary_functions.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace ballpiston {
namespace {

constexpr double kAtanOfEighths[] = {0,
                                     0x1.fd5ba9aac2f6ep-4,
                                     0x1.f5b75f92c80ddp-3,
                                     0x1.6f61941e4def1p-2,
                                     0x1.dac670561bb4fp-2,
                                     0x1.1e00babdefeb4p-1,
                                     0x1.4978fa3269ee1p-1,
                                     0x1.700a7c5784634p-1,
                                     0x1.921fb54442d18p-1};

constexpr int kFirstEighth = 6;
constexpr double kLogOfEighths[] = {
    -0x1.269621134db92p-2, -0x1.1178e8227e47cp-3, 0,
    0x1.e27076e2af2e6p-4,  0x1.c8ff7c79a9a22p-3,  0x1.4618bc21c5ec2p-2};
constexpr double kLog2High = 0x1.62e42fefa2000p-1, kLog2Low = 0x1.9ef35793c7673p-41;
constexpr double kLeastExponent = -700;  // of e; smaller results leave the normal numbers

// coefficients[0] + coefficients[1] x + ...
template <size_t n>
double Polynomial(const std::array<double, n>& coefficients, double x) {
  double sum = 0;
  for (size_t i = n; i-- > 0;) sum = sum * x + coefficients[i];
  return sum;
}

// 2^k, for k of normal numbers; std::ldexp calls the C library.
double PowerOfTwo(int k) { return std::bit_cast<double>(static_cast<int64_t>(k + 1023) << 52); }

}  // namespace

double Atan2(double y, double x) {
  const double width = std::fabs(x), height = std::fabs(y);
  const double longer = std::max(width, height), shorter = std::min(width, height);
  if (longer == 0) return y;
  const int eighths = static_cast<int>(8 * (shorter / longer) + 0.5);
  const double c = 0.125 * eighths;
  const double r = (shorter - c * longer) / (longer + c * shorter), square = r * r;
  const double series =
      r * square *
      Polynomial<6>({-1.0 / 3, 1.0 / 5, -1.0 / 7, 1.0 / 9, -1.0 / 11, 1.0 / 13}, square);
  double angle = kAtanOfEighths[eighths] + (r + series);
  if (height > width) angle = std::numbers::pi / 2 - angle;
  if (x < 0) angle = std::numbers::pi - angle;
  return std::copysign(angle, y);
}

double Power(double base, double exponent) { return Exp(exponent * Log(base)); }

double Exp(double x) {
  if (x < kLeastExponent) return 0;
  const double k = std::floor(x * std::numbers::log2e + 0.5);
  const double r = (x - k * kLog2High) - k * kLog2Low;
  const double series = Polynomial<12>(
      {1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720, 1.0 / 5040, 1.0 / 40320, 1.0 / 362880,
       1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800},
      r);
  return (1 + (r + r * r * series)) * PowerOfTwo(static_cast<int>(k));
}

double Log(double x) {
  int e;
  double m = std::frexp(x, &e);
  if (m < std::numbers::sqrt2 / 2) m *= 2, --e;
  const int eighths = static_cast<int>(8 * m + 0.5);
  const double c = 0.125 * eighths, s = (m - c) / (m + c), square = s * s;
  const double series =
      s * square *
      Polynomial<7>({2.0 / 3, 2.0 / 5, 2.0 / 7, 2.0 / 9, 2.0 / 11, 2.0 / 13, 2.0 / 15}, square);
  return e * kLog2High +
         (kLogOfEighths[eighths - kFirstEighth] + (2 * s + (series + e * kLog2Low)));
}

double WithoutLastBits(double x) {
  int exponent;
  const double mantissa = std::frexp(x, &exponent);
  return std::ldexp(std::round(mantissa * 0x1p30), exponent - 30);
}

}  // namespace ballpiston
