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
// Jerrum, Liu 2017). Properties, each with the test that bears its name:
//   1. PositionsMatchPlainRejection, in chains and in lattices.
//   2. EnergiesHaveTheirGammaLawsAtTheLocalTemperature.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/arithmetic/elementary_functions.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/gas/pauses.h"
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

// Draws a gas, with pauses. A gas of 10^6 cells takes a second.
class GasDraw {
 public:
  // The geometry and the random numbers must outlive the draw.
  GasDraw(const GasGeometry& geometry, const TemperatureProfile& temperature,
          CounterRandom& random);

  // Returns true when the gas is complete, and false at a pause; then to be called again.
  bool Advance(Pauses& pauses);
  GasState Take() { return std::move(state_); }  // of a complete gas, once

 private:
  struct Contact {
    int64_t ball;
    Direction direction;
  };

  GasBall& BallAt(int64_t i) { return state_.balls[static_cast<size_t>(i)]; }
  GasPiston& PistonAt(int64_t i) { return state_.pistons[static_cast<size_t>(i)]; }

  bool DrawPlaces(Pauses& pauses);
  void DrawPlace(GasBall& ball);
  void DrawPlace(GasPiston& piston);
  bool Separate(Pauses& pauses);
  bool IsBeyond(const Contact& contact);
  void LookForWrong(int64_t ball);
  void DrawAgain(const Contact& contact);
  void BeginRound();
  bool DrawVelocities(Pauses& pauses);

  const GasGeometry& geometry_;
  TemperatureProfile temperature_;
  CounterRandom& random_;
  GasState state_;
  // Of a round of the rejection: the balls that may be beyond a piston; the contacts in which they
  // are, which are then drawn again; and the balls that may be beyond a piston after that.
  std::vector<int64_t> suspects_, next_suspects_;
  std::vector<Contact> wrong_;
  // The numbers of steps that are done, in the order of the draw.
  size_t placed_balls_ = 0, placed_pistons_ = 0, looked_at_ = 0, drawn_again_ = 0;
  size_t moving_balls_ = 0, moving_pistons_ = 0;
};

GasState DrawGas(const GasGeometry& geometry, const TemperatureProfile& temperature,
                 CounterRandom& random);

// A component of a thermal velocity: Gaussian with variance T.
double DrawThermalVelocity(double temperature, CounterRandom& random);

// The speed of a piston that leaves a thermal wall: the flux law (v/T) exp(-v^2/(2 T)).
inline double DrawFluxSpeed(double temperature, CounterRandom& random) {
  return std::sqrt(-2 * temperature * Log(random.Uniform()));
}

}  // namespace ballpiston
