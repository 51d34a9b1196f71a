// Draws gases in local equilibrium: positions uniform over all permitted configurations, velocities
// Gaussian.
//
// A ball at temperature T has the energy law Gamma(1), exp(-e/T)/T, a piston Gamma(1/2). All
// velocities are independent of each other and of the positions. With one temperature this is the
// canonical ensemble, which is invariant under the gas's flow.
//
// Positions are drawn by partial rejection sampling: draw all balls and pistons; then draw again,
// all at once, every ball and piston that are on the wrong sides of each other; repeat until no
// such pair is left. Two such pairs that share a ball or a piston exclude each other, because the
// parts of a cell that its pistons cut off do not overlap. In this case the method is exact (Guo,
// Jerrum, Liu 2017). Property, with the test that bears its name:
//   1. PositionsMatchPlainRejection, in chains and in lattices.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/arithmetic/elementary_functions.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/sampling/counter_random.h"

namespace ballpiston {

// A temperature that depends on x, in cells from the left end. T^(3/2) falls linearly from one end
// to the other, as in a stationary gas whose conductivity grows as sqrt T. Relative errors are some
// ulps everywhere, also next to a cold end. Equal temperatures give exactly the same temperature
// everywhere.
class TemperatureProfile {
 public:
  explicit TemperatureProfile(double everywhere) : TemperatureProfile(everywhere, everywhere, 1) {}
  // hot >= cold > 0
  TemperatureProfile(double hot, double cold, double length)
      : hot_(hot), cold_(cold), length_(length), ratio_(cold / hot * std::sqrt(cold / hot)) {}

  double At(double x) const {        // 0 <= x <= length
    if (x >= length_) return cold_;  // the ratio may be 0 by underflow
    return std::max(hot_ * Power(((length_ - x) + ratio_ * x) / length_, 2.0 / 3), cold_);
  }

 private:
  double hot_;
  double cold_;
  double length_;
  double ratio_;  // (cold/hot)^(3/2)
};

// Draws a gas. Drawing a gas of 10^6 cells takes a second.
GasState DrawGas(const GasGeometry& geometry, const TemperatureProfile& temperature,
                 CounterRandom& random);

// A component of a thermal velocity: Gaussian with variance T.
double DrawThermalVelocity(double temperature, CounterRandom& random);

// The speed of a piston that leaves a thermal wall: the flux law (v/T) exp(-v^2/(2 T)).
inline double DrawFluxSpeed(double temperature, CounterRandom& random) {
  return std::sqrt(-2 * temperature * Log(random.Uniform()));
}

}  // namespace ballpiston
