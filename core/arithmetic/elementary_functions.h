// Elementary functions made of only +, -, *, / and sqrt. They are used where a last bit can change
// a count.
//
// The C library chooses its functions by the processor, with or without fused multiply-add, and the
// last bits differ. Then an angle could fall into another bin, or a proposal be accepted on one
// machine only. The functions here give the same bits on every machine with IEEE 754 doubles, if
// the compiler does not contract operations.
//
// Errors are in units in the last place of the exact result. Properties, each with a test of its
// name:
//   1. AnglesAreWithinTheirBound.
//   2. PowersAreWithinTheirBound.
//   3. ExponentialsAreWithinTheirBound.
//   4. LogarithmsAreWithinTheirBound.
//   5. AnglesOnAxesAndDiagonals are exact.
//   6. SimpleValuesAreExact, of powers, exponentials and logarithms.
//
// Pure functions: safe from any thread.
#pragma once

namespace ballpiston {

inline constexpr double kAtan2UlpError = 0.55;
inline constexpr double kPowerUlpError = 0.75;
inline constexpr double kExpUlpError = 0.75;
inline constexpr double kLogUlpError = 0.55;

// The angle of (x, y) to the x axis, in [-pi, pi], with the sign of y, also if y is a signed zero.
// The angle of (0, 0) is 0. Domain: the larger of |x| and |y| in [1e-150, 1e150], or both 0. The
// bound holds for angles of at least 1e-290.
double Atan2(double y, double x);

// base^exponent. Domain: 0 < base <= 1, base at least 1e-290; 0 <= exponent <= 1000. Below 1e-300
// the result may be 0.
double Power(double base, double exponent);

// e^x. Domain: x <= 700, including minus infinity. Below x = -700 the result is 0.
double Exp(double x);

// The natural logarithm. Domain: x in [1e-290, 1e290].
double Log(double x);

// x rounded to 30 bits. Use it for numbers that depend on functions of the C library, whose last
// bits differ between processors: a mean free time, and times measured in it. After rounding, a
// difference remains only for about one geometry in a million, whose number is about half-way
// between two rounded numbers. Rounding changes
// results by much less than their statistical errors.
double WithoutLastBits(double x);

}  // namespace ballpiston
