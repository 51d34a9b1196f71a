// The range of temperatures, and of inverse temperatures, for closed forms and for gases.
//
// Units: the Boltzmann constant is 1, so a temperature is an energy; masses are 1, lengths are
// cells. Over this range, powers of T up to T^(5/2) stay in the range of double.
#pragma once

namespace ballpiston {

inline constexpr double kMinTemperature = 1e-120;
inline constexpr double kMaxTemperature = 1e120;

}  // namespace ballpiston
