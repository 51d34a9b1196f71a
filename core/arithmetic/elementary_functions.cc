// Derivation.
//
// Angle. With t = short side/long side in [0, 1] and c = k/8 the nearest eighth,
//     atan t = atan c + atan r,   r = (t - c)/(1 + c t),   |r| <= 1/16,
// The first term is from a table in twice the precision, the second from its series. The octant
// adds 0, pi/2 or pi. These constants and r also have twice the precision, so only the last sum is
// rounded at the size of the result.
//
// Power. log(base^exponent) reaches 700, so the logarithm needs ten bits more than the result. With
// base = 2^e m, 1/sqrt2 <= m < sqrt2 and c = k/8 next to m,
//     log base = e log 2 + log c + 2 atanh s,   s = (m - c)/(m + c),   |s| < 1/22,
// where m - c is exact and s is kept as a sum of two doubles. The cubic term of the series is only
// 2^-10 of s, so it may be rounded. Then exp = 2^k exp(r), |r| <= log(2)/2, by its series.
#include "core/arithmetic/elementary_functions.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace ballpiston {
namespace {

// A number as the sum of a double and a small remainder.
struct Split {
  double high;
  double low;
};

constexpr Split kAtanOfEighths[] = {{0, 0},
                                    {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
                                    {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                    {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
                                    {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                    {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
                                    {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                    {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
                                    {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};
constexpr Split kPi = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
constexpr Split kHalfPi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};

constexpr int kFirstEighth = 6;
constexpr Split kLogOfEighths[] = {
    {-0x1.269621134db92p-2, -0x1.e0efadd9db02bp-56},
    {-0x1.1178e8227e47cp-3, 0x1.0e63a5f01c691p-58},
    {0, 0},
    {0x1.e27076e2af2e6p-4, -0x1.61578001e0162p-60},
    {0x1.c8ff7c79a9a22p-3, -0x1.4f689f8434012p-57},
    {0x1.4618bc21c5ec2p-2, 0x1.f42decdeccf1dp-56},
};
constexpr Split kLog2 = {0x1.62e42fefa2000p-1, 0x1.9ef35793c7673p-41};  // times a short int: exact
constexpr double kOneOverLog2 = 0x1.71547652b82fep+0;
constexpr double kLeastExponent = -700;  // of e; smaller results leave the normal numbers

// Exactly a + b (Knuth).
Split Sum(double a, double b) {
  const double sum = a + b, rest = sum - a;
  return {sum, (a - (sum - rest)) + (b - rest)};
}

// The upper 26 bits (Veltkamp), and the others.
Split Halves(double a) {
  const double scaled = 0x1.000002p+27 * a;
  const double high = scaled - (scaled - a);
  return {high, a - high};
}

// Exactly a b (Dekker).
Split Product(double a, double b) {
  const Split x = Halves(a), y = Halves(b);
  const double product = a * b;
  const double rest =
      ((x.high * y.high - product) + x.high * y.low + x.low * y.high) + x.low * y.low;
  return {product, rest};
}

// a/b to twice the precision, nearly.
Split Quotient(const Split& a, const Split& b) {
  const double quotient = a.high / b.high;
  const Split back = Product(quotient, b.high);
  const double rest = (a.high - back.high) - back.low + (a.low - quotient * b.low);
  return {quotient, rest / b.high};
}

// coefficients[0] + coefficients[1] x + ...
template <size_t n>
double Polynomial(const std::array<double, n>& coefficients, double x) {
  double sum = 0;
  for (size_t i = n; i-- > 0;) sum = sum * x + coefficients[i];
  return sum;
}

Split Logarithm(double x) {
  int e;
  double m = std::frexp(x, &e);
  if (m < M_SQRT1_2) m *= 2, --e;
  const int eighths = static_cast<int>(8 * m + 0.5);
  const Split& log_c = kLogOfEighths[eighths - kFirstEighth];
  const double c = 0.125 * eighths;
  const Split quotient = Quotient({m - c, 0}, Sum(m, c));
  const double s = quotient.high, square = s * s;
  const double series =
      s * square *
      Polynomial<7>({2.0 / 3, 2.0 / 5, 2.0 / 7, 2.0 / 9, 2.0 / 11, 2.0 / 13, 2.0 / 15}, square);
  const Split whole = Sum(e * kLog2.high, log_c.high), high = Sum(whole.high, 2 * s);
  const double low = e * kLog2.low + log_c.low + 2 * quotient.low * (1 + square);
  return Sum(high.high, whole.low + high.low + (low + series));
}

// 2^k, for k of normal numbers; std::ldexp calls the C library.
double PowerOfTwo(int k) { return std::bit_cast<double>(static_cast<int64_t>(k + 1023) << 52); }

// exp(x.high + x.low), x.high <= 700.
double Exponential(const Split& x) {
  if (x.high < kLeastExponent) return 0;
  const double k = std::floor(x.high * kOneOverLog2 + 0.5);
  const Split r = Sum(x.high - k * kLog2.high, x.low - k * kLog2.low);
  const double series = Polynomial<12>(
      {1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720, 1.0 / 5040, 1.0 / 40320, 1.0 / 362880,
       1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800},
      r.high);
  const Split sum = Sum(1, r.high);
  const double mantissa = sum.high + (sum.low + r.low + r.high * r.high * series);
  return mantissa * PowerOfTwo(static_cast<int>(k));
}

}  // namespace

double Atan2(double y, double x) {
  const double width = std::fabs(x), height = std::fabs(y);
  const double longer = std::max(width, height), shorter = std::min(width, height);
  if (longer == 0) return y;
  const int eighths = static_cast<int>(8 * (shorter / longer) + 0.5);
  const Split& atan_c = kAtanOfEighths[eighths];
  const double c = 0.125 * eighths;
  const Split part = Product(c, longer), rest = Sum(shorter, -part.high);
  const Split quotient = Quotient({rest.high, rest.low - part.low}, Sum(longer, c * shorter));
  const double r = quotient.high, square = r * r;
  const double series =
      r * square *
      Polynomial<6>({-1.0 / 3, 1.0 / 5, -1.0 / 7, 1.0 / 9, -1.0 / 11, 1.0 / 13}, square);
  // The angle from the nearest axis, added to the angle of that axis.
  const bool steep = height > width;
  const Split axis = steep ? kHalfPi : x < 0 ? kPi : Split{0, 0};
  const double sign = steep != (x < 0) ? -1 : 1;
  const Split whole = Sum(axis.high, sign * atan_c.high), sum = Sum(whole.high, sign * r);
  const double low = sum.low + (whole.low + axis.low + sign * atan_c.low);
  return std::copysign(sum.high + (low + sign * (quotient.low + series)), y);
}

double Power(double base, double exponent) {
  const Split log = Logarithm(base), product = Product(exponent, log.high);
  return Exponential(Sum(product.high, product.low + exponent * log.low));
}

double Exp(double x) { return Exponential({x, 0}); }

double Log(double x) {
  const Split log = Logarithm(x);
  return log.high + log.low;
}

double WithoutLastBits(double x) {
  int exponent;
  const double mantissa = std::frexp(x, &exponent);
  return std::ldexp(std::round(mantissa * 0x1p30), exponent - 30);
}

}  // namespace ballpiston
