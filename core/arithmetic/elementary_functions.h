// The elementary functions that decide what is counted, made of +, -, *, / and sqrt alone.
//
// The C library picks its own by the processor, with fused multiply-add or without, and their last
// bits differ: an angle that falls into the neighbouring bin, a proposal that is accepted on one
// machine only. These give the same bits wherever doubles are IEEE 754's and nothing is contracted.
//
// Errors are in units in the last place of the exact result. Properties, each with a test of its
// name:
//   1. AnglesAreWithinTheirBound.
//   2. PowersAreWithinTheirBound.
//   3. ExponentialsAreWithinTheirBound.
//   4. LogarithmsAreWithinTheirBound.
//   5. AnglesOnAxesAndDiagonals, PowersOfOne and ExponentialOfZeroAndLogarithmOfOne are exact.
//
// Pure functions: safe from any thread.
#ifndef BALLPISTON_CORE_ARITHMETIC_ELEMENTARY_FUNCTIONS_H_
#define BALLPISTON_CORE_ARITHMETIC_ELEMENTARY_FUNCTIONS_H_

namespace ballpiston {

inline constexpr double kAtan2UlpError = 0.55;
inline constexpr double kPowerUlpError = 0.75;
inline constexpr double kExpUlpError = 0.75;
inline constexpr double kLogUlpError = 0.55;

// The angle of (x, y) to the x axis, in [-pi, pi], with the sign of y, also of a zero; that of
// (0, 0) is 0. Domain: the larger of |x| and |y| in [1e-150, 1e150], or both 0. The bound holds for
// angles of at least 1e-290.
double Atan2(double y, double x);

// base^exponent. Domain: 0 < base <= 1, base at least 1e-290; 0 <= exponent <= 1000. Below 1e-300
// the result may be 0.
double Power(double base, double exponent);

// e^x. Domain: x <= 700, infinitely negative too. Below x = -700 the result is 0.
double Exp(double x);

// The natural logarithm. Domain: x in [1e-290, 1e290].
double Log(double x);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_ARITHMETIC_ELEMENTARY_FUNCTIONS_H_
